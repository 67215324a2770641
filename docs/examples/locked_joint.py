"""A joint that is locked: a brake is on, a motor is broken, or a cable must not be wound up."""

import pinograsp

LOCKED = {"joint_1": 0.0}  # rad: the arm stays in the plane of the box's middle


def main(starts: int = 200) -> None:
    """Plan with the joint held at its angle, and see that every grasp keeps it there."""
    robot = pinograsp.load_robot("gen3_2f85")
    scene = pinograsp.load_scene("glovebox")
    free = pinograsp.plan(robot, scene, task="sphere", starts=starts)
    locked = pinograsp.plan(robot, scene.with_task("sphere", lock=LOCKED), task="sphere", starts=starts)

    for name, result in (("free", free), ("locked", locked)):
        print(f"{name}: {result.verified} of {result.done} starts verified")
        if result.best is not None:
            print(f"  U = {result.best.cost.U:.3f}, joint_1 at {result.best.joints['joint_1']: .4f} rad")
    for kind, blocked in locked.blocked.items():
        print(f"  blocked by {kind}: {blocked.starts} starts")
    assert all(abs(grasp.joints["joint_1"]) < 1e-9 for grasp in locked.grasps)


if __name__ == "__main__":
    main()
