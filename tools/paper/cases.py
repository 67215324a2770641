"""The four cases of the paper (section 5): what it prints of each, and the marks to reach.

Forces are those on the object in the base frame of the arm (x along gravity), N; finger 1 is the one on the side of
the first desired point, world +y. q_c is in mm and y in N: Table 4 has the heads of these two columns swapped.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

Row = tuple[float, ...]
STARTS = 1304
V_LEAST = 2.1787
"""V of two hard fingers that carry 1 N of weight each: no grasp can have less."""


@dataclass(frozen=True)
class Printed:
    """The printed result of a case and its rows of Tables 4 and 5, as printed."""

    sim: int
    figure: int
    """Number of the figure with the sorted costs."""
    verified: int
    U: float
    phi_mm2: float
    V: float
    q_a: Row
    sigma: float
    q_c: Row
    y: float
    q: Row
    q_r: Row
    f_1: Row
    f_2: Row


@dataclass(frozen=True)
class Marks:
    """What a run of 1304 starts has to reach."""

    verified: float
    """Least share of verified starts."""
    near_best: float | None
    """Least share of these within 1 % + 1 mm^2 of the best U; None: only reported."""
    most_U: float
    least_U: float = 0.0
    """A U below it would be wrong."""
    penetration_mm: float | None = None
    """How deep a link of the best grasp may be in the object."""


@dataclass(frozen=True)
class Case:
    """A task of a scene, with what the paper prints of it."""

    name: str
    title: str
    scene: str
    task: str
    printed: Printed
    marks: Marks


_PAPER = {
    case.name: case
    for case in (
        Case(
            name="sphere",
            title="sphere",
            scene="glovebox",
            task="sphere",
            printed=Printed(
                sim=1,
                figure=4,
                verified=722,
                U=2.178,
                phi_mm2=3.5e-5,
                V=2.178,
                q_a=(1.224, -0.638, 0.231, 1.344, 1.899, -1.698, 0.737),
                sigma=2.017,
                q_c=(-5.760, -5.730),
                y=5.055,
                q=(2.017, -0.446, -0.638, 0.446),
                q_r=(2.004, -0.433, 1.137, 0.433),
                f_1=(-1.000, -3.631, 0.000),
                f_2=(-0.999, 3.631, -0.000),
            ),
            marks=Marks(verified=0.88, near_best=0.85, most_U=2.180),
        ),
        Case(
            name="case1",
            title="can, case 1",
            scene="glovebox_can",
            task="can",
            printed=Printed(
                sim=2,
                figure=7,
                verified=479,
                U=5.094,
                phi_mm2=2.912,
                V=2.181,
                q_a=(1.671, -0.785, -0.471, 1.937, 6.155, -1.168, 1.857),
                sigma=2.116,
                q_c=(-3.236, -1.938),
                y=-5.111,
                q=(2.116, -0.546, -0.785, 0.546),
                q_r=(2.104, -0.534, 1.036, 0.534),
                f_1=(-0.985, -3.630, 0.092),
                f_2=(-1.014, 3.630, -0.092),
            ),
            marks=Marks(verified=0.80, near_best=0.45, most_U=2.185),
        ),
        Case(
            name="case2",
            title="can near a wall, case 2",
            scene="glovebox_can_near_wall",
            task="can",
            printed=Printed(
                sim=3,
                figure=10,
                verified=101,
                U=3738.0,
                phi_mm2=3736.0,
                V=2.195,
                q_a=(0.989, -0.362, 2.711, -0.875, 4.343, -1.407, -3.642),
                sigma=2.116,
                q_c=(-2.862, -6.268),
                y=5.087,
                q=(2.116, -0.545, -0.362, 0.545),
                q_r=(2.104, -0.533, 1.036, 0.533),
                f_1=(-1.062, -0.872, 3.527),
                f_2=(-0.937, 0.872, -3.527),
            ),
            marks=Marks(verified=0.75, near_best=None, most_U=290.0, penetration_mm=0.02),
        ),
        Case(
            name="case3",
            title="can, limited region, case 3: contact points, as in the paper",
            scene="glovebox_can",
            task="can_region_point",
            printed=Printed(
                sim=4,
                figure=12,
                verified=507,
                U=2410.0,
                phi_mm2=2408.0,
                V=2.198,
                q_a=(-0.149, -0.307, 2.512, -0.254, 0.750, -1.668, 1.428),
                sigma=2.116,
                q_c=(-5.496, -2.417),
                y=4.987,
                q=(2.116, -0.545, -0.307, 0.546),
                q_r=(2.105, -0.534, 1.036, 0.534),
                f_1=(-0.840, -3.630, -0.029),
                f_2=(-1.159, 3.630, 0.029),
            ),
            marks=Marks(verified=0.88, near_best=0.88, least_U=2314.2, most_U=2315.0),
        ),
    )
}

CASES = _PAPER | {
    "case3_footprint": replace(
        _PAPER["case3"],
        name="case3_footprint",
        title="can, limited region, case 3: footprints",
        task="can_region",
        marks=replace(_PAPER["case3"].marks, near_best=None, least_U=2382.4, most_U=2390.0),
    )
}
"""The paper's cases, the last one both with contact points, as the paper has it, and with footprints in the region."""
