"""First plan: the best grasp of the sphere in the glovebox, its joints, its contacts and what proves it."""

import pinograsp


def main(starts: int = 1304) -> None:
    """Plan, print the best grasp, and write the result and its page."""
    robot = pinograsp.load_robot("gen3_2f85")
    scene = pinograsp.load_scene("glovebox")
    result = pinograsp.plan(robot, scene, task="sphere", starts=starts, seed=0)

    best = result.best
    if best is None:  # no start led to a grasp: the result says why
        print(*result.warnings, sep="\n")
        for kind, blocked in result.blocked.items():
            print(f"{kind}: {blocked.starts} starts, nearest miss {blocked.nearest_miss:.3g} {blocked.unit}")
        return

    print(f"{result.verified} of {result.done} starts verified, {len(result.grasps)} distinct grasps")
    print(f"U = {best.cost.U:.3f}")
    for name, angle in best.joints.items():
        print(f"{name:45} {angle: .4f} rad")
    for contact in best.contacts:
        print(f"{contact.pad}: at {contact.point.round(4)} m, force {contact.force.round(3)} N")
    for figure in best.certificate.figures:
        print(f"{figure.name:20} {figure.shown_value:>14}  {figure.shown_limit}")

    pinograsp.write_json(result, "glovebox_sphere.json")
    pinograsp.visualization.write_html(result, "glovebox_sphere.html")


if __name__ == "__main__":
    main()
