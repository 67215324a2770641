"""The order of grasps, the Pareto front, and the grasps that differ: made-up grasps, and what holds for any."""

from __future__ import annotations

import dataclasses
import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinograsp import InputError, Result, Robot
from pinograsp.arrays import without_turns
from pinograsp.descriptions import Scene
from pinograsp.results import CRITERIA, Cost, Criterion, Grasp, Setup, html, merge, ranking, table
from pinograsp.results.criteria import numbers_of
from pinograsp.results.decoding import decode_by_types
from pinograsp.results.different import JOINT, POSITION, ROTATION
from pinograsp.results.encoding import encode
from pinograsp.verification import Certificate, Figure
from pinograsp.visualization import comparison

FIGURES = {
    "Q": ("Q_force", "m/s^2"),
    "turn": ("Q_torque", "m/s^2"),
    "walls": ("enclosure clearance", "m"),
    "obstacles": ("obstacle clearance", "m"),
    "self": ("self clearance", "m"),
    "target": ("object clearance", "m"),
    "reserve": ("joint reserve", "rad"),
    "w": ("manipulability", "m^3"),
}


def grasp(
    start: int = 0, U: float = 2.0, count: int = 1, wrist: Any = None, q: Any = (0.0,), **figures: float
) -> Grasp:
    """Return a grasp with these figures; those that are not given are missing."""
    made = (Figure(FIGURES[key][0], value, -math.inf, FIGURES[key][1], "at least") for key, value in figures.items())
    none = np.zeros(0)
    return Grasp(
        start=start,
        count=count,
        joints={},
        q_arm=np.array(q, dtype=float),
        synergy=none,
        contact_parameters=none,
        internal_forces=none,
        q_r={},
        cost=Cost(U, 0.0, U),
        contacts=(),
        certificate=Certificate(tuple(made)),
        T_world_wrist=np.eye(4) if wrist is None else wrist,
    )


@pytest.fixture(scope="module")
def setup(gen3: Robot, glovebox: Scene) -> Setup:
    return Setup(gen3.description, glovebox, "sphere")


def result_of(setup: Setup, *grasps: Grasp) -> Result:
    return Result(setup, grasps, len(grasps), {"converged": len(grasps)}, len(grasps), 0, {})


def starts(grasps: Any) -> list[int]:
    return [grasp.start for grasp in grasps]


def delta(U: float) -> float:
    """How much greater a U must be to decide."""
    return 0.01 * abs(U) + 1.0


# The order.


def test_U_decides_beyond_one_percent_and_one_square_millimetre() -> None:
    least, just, beyond = grasp(0, 100.0, Q=1.0), grasp(1, 101.99, Q=9.0), grasp(2, 102.01, Q=99.0)
    assert starts(ranking.ordered((beyond, least, just))) == [1, 0, 2]


def test_the_next_tier_begins_with_the_least_U_beyond() -> None:
    U = np.array([4.5, 2.0, 3.02, 3.03, 4.0600, 4.0604, 4.07])
    #     least U of each tier: 2, 3.03, 4.0604
    assert ranking.tiers(U).tolist() == [2, 0, 0, 1, 1, 2, 2]


@pytest.mark.parametrize(("criterion", "worse", "better"), [
    ("Q", 1.0, 1.1), ("walls", 0.01, 0.011), ("obstacles", 0.01, 0.011), ("self", 0.01, 0.011),
    ("target", 0.01, 0.011), ("reserve", 0.1, 0.11), ("w", 0.05, 0.06),
])  # fmt: skip
def test_in_a_tier_more_is_better(criterion: str, worse: float, better: float) -> None:
    first, second = grasp(0, 2.0, **{criterion: worse}), grasp(1, 2.1, **{criterion: better})
    assert starts(ranking.ordered((first, second))) == [1, 0]


def test_torque_does_not_count_in_the_score() -> None:
    """It goes with the force, which would count twice."""
    assert starts(ranking.ordered((grasp(0, 2.0, turn=1.0), grasp(1, 2.1, turn=9.0)))) == [0, 1]


def test_the_score_is_the_mean_share_of_those_that_are_no_better() -> None:
    """By hand: shares of Q are 1, 1/2, 0; of clearance 1/4, 1/4, 1; of reserve 1/4, 1, 1/4."""
    a = grasp(0, Q=30.0, walls=0.006, reserve=0.1)
    b = grasp(1, Q=20.0, walls=0.006, reserve=0.2)
    c = grasp(2, Q=10.0, walls=0.050, reserve=0.1)
    assert starts(ranking.ordered((c, a, b))) == [1, 0, 2]  # 7/12, 1/2, 5/12


def test_the_clearance_is_the_least_of_those_that_there_are() -> None:
    criterion = {c.name: c for c in CRITERIA}["clearance"]
    made = [grasp(walls=0.03, self=0.02, target=0.04), grasp(Q=1.0), grasp(obstacles=0.01, self=math.nan)]
    np.testing.assert_array_equal(criterion.values([numbers_of(one) for one in made]), [0.02, math.nan, 0.01])


def test_every_criterion_counts_the_same_whatever_its_unit() -> None:
    """Best in two, worst in one, however far."""
    a = grasp(0, Q=10.0, walls=0.010, reserve=0.001)
    b = grasp(1, Q=9.9, walls=0.0098, reserve=3.0)
    assert starts(ranking.ordered((b, a))) == [0, 1]


def test_rounding_errors_order_nothing() -> None:
    a = grasp(0, 2.0, Q=5.0, walls=0.005 - 1e-9, reserve=0.02)
    b = grasp(1, 2.0 + 1e-9, Q=5.0 + 1e-9, walls=0.005 + 1e-9, reserve=0.02 + 1e-9)
    assert starts(ranking.ordered((b, a))) == [0, 1]


def test_who_lacks_a_figure_is_worse_in_it() -> None:
    assert starts(ranking.ordered((grasp(0), grasp(1, Q=0.0), grasp(2, Q=math.nan)))) == [1, 0, 2]


def test_equal_scores_are_ordered_by_U_and_by_start() -> None:
    assert starts(ranking.ordered((grasp(3, 2.1), grasp(2, 2.0), grasp(1, 2.0)))) == [1, 2, 3]


def test_nothing_to_order(setup: Setup) -> None:
    empty = result_of(setup)
    assert (empty.ranked(), empty.ranked("Q"), empty.pareto(), empty.different()) == ((), (), (), ())


def test_merged_grasps_are_in_the_default_order() -> None:
    def at(q: float, found: Grasp) -> Grasp:
        contact = dataclasses.make_dataclass("Contact", ["point"])(np.zeros(3))
        return dataclasses.replace(found, joints={"joint": q}, contacts=(contact,))

    merged = merge([at(0.0, grasp(0, 2.0, Q=1.0)), at(0.01, grasp(1, 2.1, Q=5.0)), at(1.0, grasp(2, 2.1, Q=2.0))])
    assert [(found.start, found.count) for found in merged] == [(2, 1), (0, 2)]


def numbers(few: bool) -> Any:
    """Return a strategy of values, some of them missing; few different ones, or many."""
    value = st.integers(0, 3).map(float) if few else st.floats(0.0, 20.0)
    return st.none() | value


@st.composite
def many_grasps(draw: Any) -> list[Grasp]:
    few = draw(st.booleans())
    U = st.floats(1.0, 8.0) if draw(st.booleans()) else st.sampled_from([2.0, 2.5, 3.5, 600.0, 605.0])
    rows = draw(st.lists(st.tuples(U, numbers(few), numbers(few), numbers(few), numbers(few)), min_size=1, max_size=25))
    made = []
    for start, (cost, *values) in enumerate(rows):
        known = zip(("Q", "walls", "reserve", "w"), values, strict=True)
        made.append(grasp(start, cost, **{key: value for key, value in known if value is not None}))
    return made


@given(many_grasps(), st.randoms(use_true_random=False))
def test_the_order_of_the_input_does_not_count(grasps: list[Grasp], random: Any) -> None:
    shuffled = random.sample(grasps, len(grasps))
    assert starts(ranking.ordered(shuffled)) == starts(ranking.ordered(grasps))
    assert starts(ranking.pareto_front(shuffled)) == starts(ranking.pareto_front(grasps))
    for by in ("score", "U", "Q", "clearance"):
        assert starts(ranking.ordered_by(shuffled, by)) == starts(ranking.ordered_by(grasps, by))


@given(many_grasps())
def test_a_U_that_is_greater_by_more_than_that_never_comes_first(grasps: list[Grasp]) -> None:
    """For every pair, tiers or not; and what comes out is what went in."""
    found = ranking.ordered(grasps)
    for before, after in itertools.combinations(found, 2):
        assert after.cost.U + delta(after.cost.U) >= before.cost.U
    assert sorted(starts(found)) == starts(grasps)


@given(many_grasps())
def test_tiers_hold_what_is_near_their_least_U_and_are_in_order(grasps: list[Grasp]) -> None:
    found = ranking.ordered(grasps)
    U = np.array([one.cost.U for one in found])
    tier = ranking.tiers(U)
    assert (np.diff(tier) >= 0).all()
    for number in range(tier.max() + 1):
        least = U[tier == number].min()
        assert (U[tier == number] <= least + delta(least)).all()
        assert (U[tier > number] > least + delta(least)).all()


def levels(found: Grasp, names: tuple[str, ...]) -> list[float]:
    """Return the values of a grasp in whole multiples of the resolution, more is better: written a second time."""
    values = {figure.name: figure.value for figure in found.certificate.figures}
    of = {
        "U": -round(found.cost.U / 0.01),
        "Q_force": round(values["Q_force"] / 0.01) if "Q_force" in values else -math.inf,
        "clearance": round(values["enclosure clearance"] / 1e-4) if "enclosure clearance" in values else -math.inf,
        "reserve": round(values["joint reserve"] / 1e-3) if "joint reserve" in values else -math.inf,
        "manipulability": round(values["manipulability"] / 1e-4) if "manipulability" in values else -math.inf,
    }
    return [of[name] for name in names]


def dominates(one: list[float], other: list[float]) -> bool:
    return one != other and all(a >= b for a, b in zip(one, other, strict=True))


@given(many_grasps())
def test_who_dominates_comes_first_in_a_tier(grasps: list[Grasp]) -> None:
    names = ("Q_force", "clearance", "reserve", "manipulability")
    found = ranking.ordered(grasps)
    tier = ranking.tiers(np.array([one.cost.U for one in found]))
    for (i, before), (j, after) in itertools.combinations(enumerate(found), 2):
        assert tier[i] != tier[j] or not dominates(levels(after, names), levels(before, names))


@given(many_grasps())
def test_the_score_is_that_of_its_definition(grasps: list[Grasp]) -> None:
    """Counted pair by pair."""
    names = ("Q_force", "clearance", "reserve", "manipulability")
    tier = ranking.tiers(np.array([one.cost.U for one in grasps])).tolist()
    score = []
    for i, one in enumerate(grasps):
        others = [levels(other, names) for j, other in enumerate(grasps) if j != i and tier[j] == tier[i]]
        mine = levels(one, names)
        score.append(sum((a > b) + 0.5 * (a == b) for other in others for a, b in zip(mine, other, strict=True)))
    expected = sorted(range(len(grasps)), key=lambda i: (tier[i], -score[i], grasps[i].cost.U, i))
    assert starts(ranking.ordered(grasps)) == expected


# One criterion alone.


def test_a_further_criterion_is_one_more_entry(setup: Setup, monkeypatch: pytest.MonkeyPatch) -> None:
    """It counts in the score and gets its columns."""
    toy = Criterion(
        name="toy",
        meaning="",
        figures=("contact gap",),
        better="least",
        unit="m",
        scored=True,
        heading="toy",
        narrow=True,
    )
    for module in (ranking, table, html, comparison):
        monkeypatch.setattr(module, "CRITERIA", (*CRITERIA, toy))
    made = [
        dataclasses.replace(grasp(i), certificate=Certificate((Figure("contact gap", gap, 1.0, "m", "at most"),)))
        for i, gap in enumerate((0.003, 0.001))
    ]
    result = result_of(setup, *made)
    assert starts(result.ranked()) == [1, 0]
    assert "toy\nmm" in [column.heading for column in table.grasp_table(result).columns]
    assert "<th>toy<small>mm</small></th>" in comparison.grasp_list(result)


def test_ranked_by_one_criterion(setup: Setup) -> None:
    a = grasp(0, 2.0, Q=1.0, turn=5.0, walls=0.02, reserve=0.3, w=0.1)
    b = grasp(1, 9.0, Q=3.0, turn=4.0, walls=0.01, reserve=0.2, w=0.3)
    c = grasp(2, 1.0, Q=2.0, turn=6.0, walls=0.03)
    result = result_of(setup, a, b, c)
    expected = {
        "U": [2, 0, 1],
        "Q": [1, 2, 0],
        "Q_force": [1, 2, 0],
        "Q_torque": [2, 0, 1],
        "clearance": [2, 0, 1],
        "reserve": [0, 1, 2],  # c has none
        "joint reserve": [0, 1, 2],
        "manipulability": [1, 0, 2],
        "enclosure clearance": [2, 0, 1],
    }
    for by, order in expected.items():
        assert starts(result.ranked(by)) == order, by
    assert result.ranked() == result.ranked("score")
    assert result.best is result.grasps[0]  # as they were given


def test_a_figure_with_an_upper_limit_is_better_if_less(setup: Setup) -> None:
    made = [
        dataclasses.replace(grasp(i), certificate=Certificate((Figure("contact gap", gap, 1e-5, "m", "at most"),)))
        for i, gap in enumerate((3e-6, 1e-6, 2e-6))
    ]
    assert starts(result_of(setup, *made).ranked("contact gap")) == [1, 2, 0]


def test_equal_values_are_in_the_default_order(setup: Setup) -> None:
    result = result_of(setup, grasp(0, Q=1.0, walls=0.01), grasp(1, Q=2.0, walls=0.01), grasp(2, Q=3.0, walls=0.02))
    assert starts(result.ranked("clearance")) == [2, 1, 0]
    assert starts(result.ranked("Q_torque")) == starts(result.ranked())  # none has it


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("clearence", "Did you mean clearance"),
        ("enclosure clearence", "Did you mean enclosure clearance"),
        ("scores", "Did you mean score?"),
        ("", "Known: "),
    ],
)
def test_unknown_names_are_refused(name: str, words: str, setup: Setup) -> None:
    result = result_of(setup, grasp(0, walls=0.01))
    for use in (result.ranked, lambda by: result.different(by=by)):
        with pytest.raises(InputError, match="no criterion and no figure is called") as caught:
            use(name)
        assert words in str(caught.value)
    with pytest.raises(InputError, match="no criterion"):
        result.pareto(("U", name))


def test_what_is_no_name_is_refused(setup: Setup) -> None:
    result = result_of(setup, grasp(0, walls=0.01))
    for by in (None, 3):
        with pytest.raises(InputError, match="the name of a criterion is wanted"):
            result.ranked(by=by)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"criteria: a list of names is wanted, not 'clearance'. Give \['clearance'\]"):
        result.pareto("clearance")
    with pytest.raises(InputError, match=r"Give \['U', 'clearance'\]$"):
        result.pareto("U, clearance")


# The Pareto front.


def test_pareto_front_by_hand(setup: Setup) -> None:
    a = grasp(0, 2.0, Q=1.0, walls=0.01, reserve=0.1)
    b = grasp(1, 2.0, Q=2.0, walls=0.01, reserve=0.1)  # beats a
    c = grasp(2, 50.0, Q=3.0, walls=0.01, reserve=0.1)
    d = grasp(3, 50.0, Q=3.0, walls=0.01, reserve=0.1)  # as c: neither beats the other
    e = grasp(4, 60.0, Q=3.0, walls=0.01, reserve=0.1)  # beaten by c
    f = grasp(5, 70.0)  # beaten by all
    result = result_of(setup, f, e, d, c, b, a)
    assert starts(result.pareto()) == [1, 2, 3]
    assert starts(result.pareto(("U",))) == [1, 0]
    assert starts(result.pareto(criteria=("Q", "enclosure clearance"))) == [2, 3, 4]


@given(many_grasps())
def test_no_member_of_the_front_is_dominated_and_everything_else_is(grasps: list[Grasp]) -> None:
    names = ("U", "Q_force", "clearance", "reserve")
    front = ranking.pareto_front(grasps)
    assert front
    inside = {one.start for one in front}
    for one in grasps:
        beaten = any(dominates(levels(member, names), levels(one, names)) for member in front)
        assert beaten == (one.start not in inside)


# Grasps that differ.


def pose(x: float = 0.0, angle: float = 0.0) -> Any:
    T = np.eye(4)
    T[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    T[0, 3] = x
    return T


DEGREE = math.radians(1.0)


@pytest.mark.parametrize(
    ("wrist", "q", "differ"),
    [
        (pose(0.0199), (0.0, 0.0), False),
        (pose(0.0201), (0.0, 0.0), True),
        (pose(angle=14.9 * DEGREE), (0.0, 0.0), False),
        (pose(angle=-15.1 * DEGREE), (0.0, 0.0), True),
        (pose(angle=math.pi), (0.0, 0.0), True),
        (pose(), (29.9 * DEGREE, -29.9 * DEGREE), False),
        (pose(), (0.0, 30.1 * DEGREE), True),
        (pose(), (0.0, 2 * math.pi), False),
        (pose(), (0.0, -(360.0 - 29.9) * DEGREE), False),
        (pose(), (0.0, (360.0 - 30.1) * DEGREE), True),
    ],
)
def test_what_differs(wrist: Any, q: Any, differ: bool, setup: Setup) -> None:
    shown = result_of(setup, grasp(0, q=(0.0, 0.0)), grasp(1, wrist=wrist, q=q)).different()
    assert [(one.grasp.start, one.starts, one.grasp_count) for one in shown] == (
        [(0, 1, 1), (1, 1, 1)] if differ else [(0, 2, 2)]
    )


def test_numbers_of_grasps(setup: Setup) -> None:
    """They are places in the result, whatever the order; also of grasps that were pickled, read or made anew."""
    result = result_of(setup, grasp(0, 3.0), grasp(1, 1.0), grasp(2, 2.0))
    assert [result.number_of(one) for one in result.grasps] == [1, 2, 3]
    assert [result.number_of(one) for one in reversed(result.grasps)] == [3, 2, 1]
    assert result.number_of(dataclasses.replace(result.grasps[1])) == 2
    twins = result_of(setup, grasp(0, 1.0), grasp(0, 1.0))
    assert [twins.number_of(one) for one in twins.grasps] == [1, 2]
    for other in (grasp(7, 3.0), None):
        with pytest.raises(InputError, match=r"^grasp: is no grasp of this result"):
            result.number_of(other)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("angle", "expected"),
    [(0.0, 0.0), (3.0, 3.0), (-3.0, -3.0), (2 * math.pi + 0.5, 0.5), (-7.0, 2 * math.pi - 7.0), (math.pi, -math.pi)],
)
def test_angles_without_whole_turns(angle: float, expected: float) -> None:
    assert without_turns(np.array([angle]))[0] == pytest.approx(expected, abs=1e-12)


def test_each_stands_behind_the_nearest_that_it_resembles(setup: Setup) -> None:
    """On a line: the best at 0 and at 25 mm are shown, 15 mm is nearer to the second, 60 mm resembles neither."""
    at = {0: 0.0, 1: 0.005, 2: 0.025, 3: 0.015, 4: 0.060}
    made = [grasp(i, 2.0 + 0.01 * i, count=10**i, wrist=pose(x)) for i, x in at.items()]
    result = result_of(setup, *made)
    assert [(one.grasp.start, one.starts, one.grasp_count) for one in result.different(2)] == [(0, 11, 2), (2, 1100, 2)]
    assert [(one.grasp.start, one.starts, one.grasp_count) for one in result.different(9)][2] == (4, 10_000, 1)
    assert [one.grasp.start for one in result.different(1)] == [0]
    assert result.different(0) == ()


def test_the_order_decides_which_are_shown(setup: Setup) -> None:
    made = [grasp(i, Q=10.0 - i, walls=0.01 * (1 + i), wrist=pose(0.015 * i)) for i in range(3)]
    result = result_of(setup, *made)
    assert [one.grasp.start for one in result.different(by="Q")] == [0, 2]
    assert [one.grasp.start for one in result.different(by="clearance")] == [2, 0]


def test_the_front_in_another_order(setup: Setup) -> None:
    """The second beats the first in both; the third is like the second's hand, the fourth stands apart."""
    made = (grasp(0, Q=1.0, walls=0.01), grasp(1, Q=2.0, walls=0.02), grasp(2, Q=1.5, walls=0.03))
    result = result_of(setup, *made, grasp(3, Q=3.0, walls=0.015, wrist=pose(0.1)))
    front = ("Q", "clearance")
    assert sorted(starts(result.pareto(front))) == [1, 2, 3]
    assert starts(result.ranked("clearance", front)) == [2, 1, 3]
    assert starts(result.ranked("Q", front)) == [3, 1, 2]
    assert [(one.grasp.start, one.grasp_count) for one in result.different(9, "clearance", front)] == [(2, 2), (3, 1)]
    with pytest.raises(InputError, match="no criterion and no figure is called 'beauty'"):
        result.ranked("Q", ("beauty",))


def apart(one: Grasp, other: Grasp) -> float:
    """Return the difference of two grasps, the rotation's angle by the trace."""
    T = np.linalg.inv(one.T_world_wrist) @ other.T_world_wrist
    angle = math.acos(min(max((np.trace(T[:3, :3]) - 1.0) / 2.0, -1.0), 1.0))
    joint = max(abs(math.remainder(a - b, 2 * math.pi)) for a, b in zip(one.q_arm, other.q_arm, strict=True))
    return max(np.linalg.norm(T[:3, 3]) / POSITION, angle / ROTATION, joint / JOINT)


SPREAD = st.tuples(st.floats(0.0, 0.1), st.floats(-3.0, 3.0), st.floats(-7.0, 7.0), st.integers(1, 5))


@given(st.lists(SPREAD, min_size=1, max_size=30), st.integers(1, 6))
def test_the_shown_differ_and_everything_near_is_behind(rows: list[Any], most: int) -> None:
    made = [grasp(i, count=n, wrist=pose(x, angle), q=(0.0, q)) for i, (x, angle, q, n) in enumerate(rows)]
    result = Result.__new__(Result)
    object.__setattr__(result, "grasps", tuple(made))
    shown = result.different(most)
    assert len(shown) <= most
    assert shown[0].grasp.start == 0
    assert all(apart(a.grasp, b.grasp) > 1.0 - 1e-6 for a, b in itertools.combinations(shown, 2))
    near = [one for one in made if min(apart(one, other.grasp) for other in shown) <= 1.0 + 1e-6]
    assert sum(one.grasp_count for one in shown) <= len(near)
    if len(shown) < most:
        assert sum(one.grasp_count for one in shown) == len(near) == len(made)
    assert sum(one.starts for one in shown) <= sum(one.count for one in near)
    assert all(one.grasp_count >= 1 for one in shown)


# From a file.


def test_it_works_on_results_that_were_read(setup: Setup) -> None:
    made = [
        grasp(i, 2.0 + 0.3 * (i % 3), Q=float(i), walls=0.01 + 0.001 * (7 * i % 5), wrist=pose(0.013 * i))
        for i in range(12)
    ]
    result = result_of(setup, *ranking.ordered(made))
    back = decode_by_types(encode(result))
    assert not back.altered
    assert starts(back.ranked()) == starts(back.grasps) == starts(result.grasps)
    assert starts(back.ranked("Q")) == list(range(11, -1, -1))
    assert starts(back.pareto()) == starts(result.pareto())
    assert [(one.grasp.start, *one[1:]) for one in back.different(4)] == [
        (one.grasp.start, *one[1:]) for one in result.different(4)
    ]
