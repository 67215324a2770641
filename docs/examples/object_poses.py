"""A scene made in Python, and the first grasp of an object at many poses from one planner that stays warm."""

import numpy as np

import pinograsp
from pinograsp import ContactConstants, Cylinder, Enclosure, Object, Pose, Scene, Task


def isolator() -> Scene:
    """Return an isolator around a table, its top at z = 0, with a can of 0.3 kg on it; m, world frame."""
    can = Object(shape=Cylinder(radius=0.033, height=0.115), pose=Pose(position=(0.55, 0.0, 0.0575)), mass=0.3)
    lift = Task(
        object="can",
        desired_contacts=((0.0, 0.033, 0.02), (0.0, -0.033, 0.02)),  # in the can's frame
        contact=ContactConstants(friction=0.9),
    )
    walls = Enclosure(min=(-0.30, -0.45, 0.0), max=(0.85, 0.45, 0.95))
    return Scene(name="isolator", enclosure=walls, objects={"can": can}, tasks={"lift": lift})


def main(poses: int = 100) -> None:
    """Put the can somewhere else again and again, and take the first grasp that is verified."""
    rng = np.random.default_rng(0)
    found = 0
    with pinograsp.Planner(pinograsp.load_robot("panda"), isolator()) as planner:
        for _ in range(poses):
            x, y = rng.uniform((0.35, -0.25), (0.65, 0.25))
            planner.move("can", Pose(position=(x, y, 0.0575), rpy=(0.0, 0.0, rng.uniform(-np.pi, np.pi))))
            grasp = next(planner.grasps("lift", most=1), None)
            if grasp is not None:
                found += 1
                print(f"can at ({x:.2f}, {y:.2f}): U = {grasp.cost.U:.2f}, arm {grasp.q_arm.round(2)}")
    print(f"a grasp at {found} of {poses} poses")


if __name__ == "__main__":
    main()
