"""The list in another order: by one criterion, by a figure, by what no other grasp beats, by hands that differ."""

import pinograsp


def main(starts: int = 200) -> None:
    """Plan once, then order what was found in several ways."""
    result = pinograsp.plan(
        pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox_can"), task="can", starts=starts
    )
    for criterion in pinograsp.CRITERIA:
        first = result.ranked(by=criterion.name)[0]
        print(f"{criterion.name:15} start {first.start:4}, U = {first.cost.U:.2f}: {criterion.meaning}")

    closest = result.ranked(by="contact gap")[0]  # any figure of the certificate will do
    print(f"contact gap {closest.certificate['contact gap'].value:.1e} m")

    front = result.pareto(("U", "clearance", "reserve"))
    print(f"{len(front)} of {len(result.grasps)} grasps: none is better in all three")

    for grasp, starts_behind, grasps_behind in result.different(5, by="clearance"):
        print(f"start {grasp.start}: found by {starts_behind} starts, {grasps_behind} grasps like it")

    # A rule of your own is a line of Python: from above, and the wrist as high as can be.
    from_above = [grasp for grasp in result.grasps if grasp.T_world_wrist[2, 2] < -0.5]
    highest = max(from_above, key=lambda grasp: float(grasp.T_world_wrist[2, 3]), default=None)
    print("none from above" if highest is None else f"wrist at {highest.T_world_wrist[:3, 3].round(3)} m")


if __name__ == "__main__":
    main()
