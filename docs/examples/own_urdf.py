"""Your own robot: from a URDF to a robot file, its check, and a first plan."""

from pathlib import Path

import pinograsp

URDF = "package://example-robot-data/robots/panda_description/urdf/panda.urdf"


def main(starts: int = 100) -> None:
    """Write my_panda/robot.yaml, check it and plan with it."""
    file = Path("my_panda/robot.yaml")
    draft = pinograsp.new_robot_file(URDF, file)
    file.parent.mkdir(exist_ok=True)
    file.write_text(draft.text)
    print(draft.checks)  # lines that hold what a URDF does not say

    report = pinograsp.check_robot(file)
    for finding in report.findings:
        print(f"{finding.level:8} {finding.what} {finding.remedy}")
    if report.wrong:
        return

    robot = pinograsp.load_robot(file)
    scene = pinograsp.load_scene("panda_table")
    result = pinograsp.plan(robot, scene, task="sphere", starts=starts)
    print(f"{result.verified} of {result.done} starts verified")


if __name__ == "__main__":
    main()
