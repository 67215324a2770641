"""A configuration of your own: what the independent check says of it, how near it comes to what, and its picture."""

import numpy as np

import pinograsp


def main(starts: int = 24) -> None:
    """Turn one joint of a grasp by a degree, and ask what is left of the grasp."""
    robot = pinograsp.load_robot("gen3_2f85")
    scene = pinograsp.load_scene("glovebox")
    best = pinograsp.plan(robot, scene, task="sphere", starts=starts).best
    assert best is not None
    joints = dict(best.joints)
    joints["joint_1"] += np.radians(1.0)

    found = pinograsp.check(robot, scene, "sphere", joints)
    print("a grasp" if found.verified else "no grasp")
    for figure in found.certificate.refuted_by:
        print(f"{figure.name}: {figure.shown_value}, wanted {figure.shown_limit} {figure.where}")
    for pair in found.clearances[:5]:  # the least first
        print(f"{pair.link} - {pair.other}: {1e3 * pair.distance:.1f} mm")
    print(f"joint reserve: {found.certificate['joint reserve'].value:.3f} rad")
    pinograsp.visualization.write_html(found, "own_configuration.html")


if __name__ == "__main__":
    main()
