"""Wrench resistance: answers known by hand, another formulation of the same programs, and the figures of claims."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import optimize
from test_verification import FINGERS, OPENING, ROOM, Case, names, scene_with

from pinograsp.descriptions import Scene, load_robot_description
from pinograsp.errors import InputError
from pinograsp.verification import balance
from pinograsp.verification.balance import SHARE, BalanceProblem, ContactPoints, Limits
from pinograsp.verification.check import Verifier
from pinograsp.verification.jacobians import rate_of_twist
from pinograsp.verification.resistance import MOST, Hold, resistance_figures

Array = NDArray[np.float64]
R = 0.04
"""Half the distance of the contacts, m."""
TAU = 8.0
"""Sum of the normal forces, N."""
MU = 0.5
X, Y, Z = np.eye(3)
FORCES, TORQUES = np.hstack([np.eye(3), np.zeros((3, 3))]), np.hstack([np.zeros((3, 3)), np.eye(3)])


def opposed(
    e: float = 0.0,
    half: float = 0.0,
    *,
    mu: float = MU,
    most: float = 100.0,
    least: float = 0.0,
    center: Any = (0.0, 0.0, 0.0),
) -> BalanceProblem:
    """Return two contacts on the x axis whose normal forces add up to TAU: points, or lines along z."""
    ends = [-half, half] if half > 0.0 else [0.0]
    points = np.array([[side * R, 0.0, z] for side in (-1.0, 1.0) for z in ends])
    normals = -np.sign(points[:, :1]) * X
    contact = np.repeat([0, 1], len(ends))
    at = ContactPoints(contact, points, normals, np.full(len(points), e), np.column_stack([normals, 0 * contact]))
    return BalanceProblem(at, TAU, Limits(mu, least, most), np.array(center), R)


# ---- where the solver gives up


def test_a_wrench_that_the_solver_gives_up_on_is_answered_by_one_next_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, wrench, solve = opposed(0.01), np.array([0.0, 0.0, -2.0, 0.0, 0.0, 0.0]), balance.maximised
    margin, multiples = problem.margin(wrench), problem.multiples(wrench, FORCES)
    given_up: list[int] = []

    def gives_up(*arguments: Any, **options: Any) -> Array:
        given_up.append(len(given_up))
        found = solve(*arguments, **options)
        return found if len(given_up) % 2 == 0 else np.full_like(found, math.nan)

    monkeypatch.setattr(balance, "maximised", gives_up)
    assert problem.margin(wrench) == pytest.approx(margin, abs=1e-5)
    np.testing.assert_allclose(problem.multiples(wrench, FORCES), multiples, atol=1e-5)
    assert len(given_up) == 4
    monkeypatch.setattr(balance, "maximised", lambda *_, **__: np.full(1, math.nan))
    assert math.isnan(problem.margin(wrench))


def test_figures_are_finite_where_friction_locks_the_fingers_in_every_direction(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A figure that is not finite would hold for nothing."""
    monkeypatch.setattr(
        BalanceProblem, "multiples", lambda self, wrench, directions: np.full(len(directions), math.inf)
    )
    for figure in resistance_figures(Hold(opposed(), np.zeros(6)), 0.2, 3.0):
        assert figure.holds
        assert figure.value == MOST


# ---- by hand


@pytest.mark.parametrize("e", [0.0, 0.01])
def test_largest_force_of_two_points(e: float) -> None:
    """Across the line: mu tau. Along it: until one contact carries f_max, or the other one f_min."""
    nothing = np.zeros(6)
    np.testing.assert_allclose(opposed(e).multiples(nothing, FORCES), [TAU, MU * TAU, MU * TAU], rtol=1e-6)
    assert opposed(e, most=5.0).multiples(nothing, FORCES)[0] == pytest.approx(2 * 5.0 - TAU, rel=1e-6)
    assert opposed(e, least=1.0).multiples(nothing, FORCES)[0] == pytest.approx(TAU - 2.0, rel=1e-6)


def test_the_load_takes_its_share_of_friction() -> None:
    """2 N along -z leave mu tau - 2 N along -z, mu tau + 2 N along z, the cone's chord along y."""
    load = np.array([0.0, 0.0, -2.0, 0.0, 0.0, 0.0])
    found = opposed().multiples(load, np.vstack([-FORCES[2], FORCES[2], FORCES[1]]))
    np.testing.assert_allclose(found, [MU * TAU - 2.0, MU * TAU + 2.0, math.sqrt((MU * TAU) ** 2 - 4.0)], rtol=1e-6)


def test_largest_torque_of_two_points() -> None:
    """Across the line a couple of friction forces. About it nothing but the spin of soft fingers: mu e tau."""
    couple = MU * TAU * R
    np.testing.assert_allclose(opposed().multiples(np.zeros(6), TORQUES), [0.0, couple, couple], rtol=1e-6)
    found = opposed(0.01).multiples(np.zeros(6), TORQUES)
    np.testing.assert_allclose(found, [MU * 0.01 * TAU, couple, couple], rtol=1e-6)


def test_lines_resist_what_points_do_not() -> None:
    """About the line that joins two contact lines of 20 mm: friction at four ends, mu tau 10 mm."""
    assert opposed(half=0.01).multiples(np.zeros(6), TORQUES[:1])[0] == pytest.approx(MU * TAU * 0.01, rel=1e-6)
    # With spin at the ends too, the ellipse of friction and spin: norm(f_t, m / e) <= mu f_n, torque 10 mm f_t + m.
    both = opposed(0.01, half=0.01).multiples(np.zeros(6), TORQUES[:1])[0]
    assert both == pytest.approx(MU * TAU * math.hypot(0.01, 0.01), rel=1e-6)
    # Normal forces that move to one end: about y, with the friction along z at both sides.
    about_y = opposed(half=0.01).multiples(np.zeros(6), TORQUES[1:2])[0]
    assert about_y == pytest.approx(TAU * (0.01 + MU * R), rel=1e-6)


def test_a_centre_of_mass_off_the_line() -> None:
    """Hard fingers cannot keep it from swinging, soft ones can; what is within the tolerance does not count."""
    off, near = (opposed(center=(0.0, 0.0, z)) for z in (0.01, 0.5 * SHARE * R))
    # Along the line the couple F 10 mm takes friction: F 10 mm / 2 R <= mu (tau - F) / 2 at the lighter contact.
    along = MU * TAU / (0.01 / R + MU)
    np.testing.assert_allclose(off.multiples(np.zeros(6), FORCES), [along, 0.0, MU * TAU], rtol=1e-6)
    np.testing.assert_allclose(near.multiples(np.zeros(6), FORCES), [TAU, MU * TAU, MU * TAU], rtol=2e-3)
    # The force F through the centre turns the object by 10 mm F: norm(F, F 10 mm / e) = mu tau.
    soft = opposed(0.005, center=(0.0, 0.0, 0.01)).multiples(np.zeros(6), FORCES)
    assert soft[1] == pytest.approx(MU * TAU / math.hypot(1.0, 2.0), rel=1e-6)


def test_a_load_that_is_not_balanced() -> None:
    too_heavy = np.array([0.0, 0.0, -MU * TAU - 0.1, 0.0, 0.0, 0.0])
    assert (opposed().multiples(too_heavy, FORCES) == 0.0).all()
    assert opposed().margin(too_heavy) < 0.0
    turning = np.array([0.0, 0.0, -1.0, 0.01, 0.0, 0.0])
    assert (opposed().multiples(turning, FORCES) == 0.0).all()
    assert opposed().margin(turning) == -math.inf
    assert opposed(0.01).margin(turning) > 0.0
    assert (opposed(least=TAU).multiples(np.zeros(6), FORCES) == 0.0).all()


def test_fingers_that_friction_locks() -> None:
    """Drives feel f_n - 4 f_z: f_n = 4 f_z may grow for ever, while f_z = -mu f_n leaves f_n = tau / 2 / (1 + 4 mu)."""
    problem = locking(np.array([0.0, 0.0, 4.0]))
    found = problem.multiples(np.zeros(6), np.vstack([FORCES[2], -FORCES[2], FORCES[0]]))
    np.testing.assert_allclose(found, [MU * TAU / (1.0 + 4.0 * MU), math.inf, TAU], rtol=1e-6)


def test_nothing_bounds_the_margin_of_what_no_drive_feels() -> None:
    assert locking(X, side=1.0).margin(np.zeros(6)) == math.inf


def locking(felt: Any, side: float = 0.0) -> BalanceProblem:
    """Return two points on the x axis without limits of force, whose drives feel f_n less something.

    Args:
        felt: what is subtracted from the drive, per unit of force, shape (3,).
        side: 1 to turn it round at the other contact.
    """
    points = np.array([-R * X, R * X])
    normals = np.array([X, -X])
    drive = normals - np.array([felt, (1.0 - 2.0 * side) * np.asarray(felt)])
    at = ContactPoints(np.arange(2), points, normals, np.zeros(2), np.column_stack([drive, np.zeros(2)]))
    return BalanceProblem(at, TAU, Limits(MU, 0.0, math.inf), np.zeros(3), R)


def test_margin() -> None:
    """Nothing to carry: s = mu tau / 2 at both contacts, or what is left to f_max. At the largest load it is 0."""
    assert opposed().margin(np.zeros(6)) == pytest.approx(MU * TAU / 2, rel=1e-6)
    assert opposed(most=5.0).margin(np.zeros(6)) == pytest.approx(5.0 - TAU / 2, rel=1e-6)
    for e, half in ((0.0, 0.0), (0.01, 0.0), (0.01, 0.01)):
        problem = opposed(e, half, most=6.0)
        load = np.array([0.1, 0.2, -1.0, 0.0, 0.01, 0.0])
        for direction in np.vstack([FORCES, -FORCES, TORQUES[1:]]):
            [a] = problem.multiples(load, direction[None])
            assert problem.margin(load + 0.999 * a * direction) > 0.0 > problem.margin(load + 1.001 * a * direction)
            assert problem.margin(load + a * direction) == pytest.approx(0.0, abs=1e-6)


# ---- beside another formulation


def scattered(rng: np.random.Generator) -> tuple[ContactPoints, Array, float]:
    """Return three contacts of one to three points about a ball of 40 mm, a load and the torque that balances it."""
    counts, rows = rng.integers(1, 4, 3), []
    for contact, count in enumerate(counts):
        angle = 2 * math.pi * contact / 3 + rng.uniform(-0.3, 0.3)
        normal = -np.array([math.cos(angle), math.sin(angle), rng.uniform(-0.2, 0.2)])
        normal /= np.linalg.norm(normal)
        e, drive = rng.choice([0.0, 0.008]), normal + 0.3 * rng.normal(size=3)
        for _ in range(count):
            across = np.cross(normal, rng.normal(size=3))
            point = -0.04 * normal + 0.01 * across / np.linalg.norm(across)
            rows.append((contact, point, normal, e, [*drive, 0.1 * rng.normal()]))
    parts = [np.array(part, dtype=float) for part in zip(*rows, strict=True)]
    at = ContactPoints(parts[0].astype(int), parts[1], parts[2], parts[3], parts[4])
    # Forces well inside their cones.
    pressing = rng.uniform(0.5, 1.5, len(at.points))[:, None] * at.normals
    forces = pressing + 0.1 * rng.normal(size=at.points.shape)
    load = -np.concatenate([forces.sum(axis=0), np.cross(at.points, forces).sum(axis=0)])
    return at, load, float((at.drive[:, :3] * forces).sum())


def largest_by_cutting_planes(at: ContactPoints, load: Array, tau: float, limits: Limits, direction: Array) -> float:
    """Return the same largest multiple by linear programs: cones are cut off plane by plane where they are violated.

    Unknowns: the multiple, the forces in world axes, the spin torques over 10 mm.
    """
    count = len(at.points)
    force = [1 + 3 * j + np.arange(3) for j in range(count)]
    spin = 1 + 3 * count + np.arange(count)
    size = 1 + 4 * count
    equations = np.zeros((7, size))
    equations[:6, 0] = direction
    for j in range(count):
        equations[:3, force[j]] = np.eye(3)
        equations[3:6, force[j]] = np.cross(at.points[j], np.eye(3)).T
        equations[3:6, spin[j]] = 0.01 * at.normals[j]
        equations[6, force[j]] = at.drive[j, :3]
        equations[6, spin[j]] = 0.01 * at.drive[j, 3]
    equations[3:6] /= 0.04
    sides = -np.concatenate([load[:3], load[3:] / 0.04, [-tau]])
    # A cone: norm(A x) <= b . x + c.
    cones, planes = [], []
    for j in range(count):
        across = np.zeros((4, size))
        across[:3, force[j]] = np.eye(3) - np.outer(at.normals[j], at.normals[j])
        across[3, spin[j]] = 0.01 / at.torsion_radius[j] if at.torsion_radius[j] > 0.0 else 0.0
        along = np.zeros(size)
        along[force[j]] = limits.friction * at.normals[j]
        cones.append((across, along, 0.0))
    for i in range(3):
        total, pressing = np.zeros((3, size)), np.zeros(size)
        for j in np.flatnonzero(at.contact == i):
            total[:, force[j]] += np.eye(3)
            pressing[force[j]] += at.normals[j]
        cones.append((total, np.zeros(size), limits.most))
        planes.append((-pressing, -limits.least))
    bounds = [
        (0.0, 1e3),
        *[(-50.0, 50.0)] * (3 * count),
        *((-50.0 * (e > 0), 50.0 * (e > 0)) for e in at.torsion_radius),
    ]
    exact = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    for _ in range(200):
        rows, limit = (np.array(part) for part in zip(*planes, strict=True))
        x = optimize.linprog(-np.eye(1, size)[0], rows, limit, equations, sides, bounds, options=exact).x
        over = [np.linalg.norm(A @ x) - b @ x - c for A, b, c in cones]
        if max(over) < 1e-6:
            return float(x[0])
        for (A, b, c), excess in zip(cones, over, strict=True):
            if excess > 0.0:
                direction_of = A @ x / np.linalg.norm(A @ x)
                planes.append((direction_of @ A - b, c))
    raise AssertionError("the linear programs do not converge")


@pytest.mark.parametrize("seed", range(6))
def test_linear_programs_agree(seed: int) -> None:
    at, load, tau = scattered(np.random.default_rng(seed))
    limits = Limits(0.8, 0.01, 6.0)
    directions = np.vstack([FORCES, 0.05 * TORQUES])
    found = BalanceProblem(at, tau, limits, np.zeros(3), 0.04).multiples(load, directions)
    assert (found > 0.01).all()
    expected = [largest_by_cutting_planes(at, load, tau, limits, direction) for direction in directions[[0, 2, 4]]]
    np.testing.assert_allclose(found[[0, 2, 4]], expected, rtol=1e-6)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_turning_everything_turns_the_answer(axis: int) -> None:
    at, load, tau = scattered(np.random.default_rng(7))
    turn = np.roll(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]), (axis, axis), axis=(0, 1))
    turned = replace(
        at,
        points=at.points @ turn.T,
        normals=at.normals @ turn.T,
        drive=np.column_stack([at.drive[:, :3] @ turn.T, at.drive[:, 3]]),
    )
    limits, both = Limits(0.8, 0.01, 6.0), np.kron(np.eye(2), turn)
    before = Hold(BalanceProblem(at, tau, limits, np.zeros(3), 0.04), load)
    after = Hold(BalanceProblem(turned, tau, limits, np.zeros(3), 0.04), both @ load)
    signs = {(axis, sign): f"{sign}{letter}" for axis, letter in enumerate("xyz") for sign in "+-"}
    for old, new in zip(resistance_figures(before, 0.2, None), resistance_figures(after, 0.2, None), strict=True):
        assert new.value == pytest.approx(old.value, rel=1e-6)
        direction = turn @ ((1.0 if old.where[0] == "+" else -1.0) * np.eye(3)["xyz".index(old.where[1])])
        to = int(np.abs(direction).argmax())
        assert new.where == signs[to, "+" if direction[to] > 0.0 else "-"]


# ---- of claims


@pytest.fixture(scope="module")
def case() -> Case:
    robot = load_robot_description("gen3_2f85")
    return Case(robot, Verifier(robot, scene_with(enclosure=ROOM), "sphere"))


def softened(case: Case, mu: float = 0.9, **task: Any) -> Scene:
    contact = {"friction": mu, "min_normal_force": 0.001, "max_force": 50.0}
    soft = {"model": "soft_finger", "torsion_radius": 0.006, "torsional_stiffness": 1.0}
    return case.scene(contact=contact, contact_model=soft, **task)


def resistance(case: Case, scene: Scene, **changes: Any) -> dict[str, float]:
    figures = Verifier(case.robot, scene, "sphere").resistance(replace(case.claim, **changes))
    return {figure.name: figure.value for figure in figures}


def test_figures(case: Case) -> None:
    figures = Verifier(case.robot, softened(case), "sphere").resistance(case.claim)
    assert [figure.name for figure in figures] == ["Q_force", "Q_torque"]
    assert all(figure.unit == "m/s^2" and figure.sense == "at least" and figure.holds for figure in figures)
    assert all(figure.limit == -math.inf and figure.value > 0.1 for figure in figures)
    assert all(len(figure.where) == 2 for figure in figures)
    hard = resistance(case, case.scene(contact_model={"model": "hard_finger"}))
    assert hard["Q_torque"] == 0.0
    # The line from pad to pad passes the centre of the ball.
    assert hard["Q_force"] > 1.0


def test_the_force_limit_of_the_plan_does_not_make_a_gripper_let_go(case: Case) -> None:
    """Its one drive bounds the forces."""
    by_limit = []
    for most in (4.0, 50.0):
        contact = {"friction": 0.9, "min_normal_force": 0.001, "max_force": most}
        by_limit.append(resistance(case, case.scene(contact=contact)))
    assert by_limit[0] == by_limit[1]


def test_a_small_residual_does_not_count(case: Case) -> None:
    """Of hard fingers, which balance some wrenches not at all: forces off by 1 uN, points by 1 um."""
    hard = case.scene(contact_model={"model": "hard_finger"})
    exact, rng = resistance(case, hard)["Q_force"], np.random.default_rng(0)
    for _ in range(5):
        forces = case.claim.forces + 1e-6 * rng.normal(size=(2, 3))
        points = case.claim.points + 1e-6 * rng.normal(size=(2, 3))
        assert resistance(case, hard, forces=forces, points=points)["Q_force"] == pytest.approx(exact, rel=1e-3)


def test_less_friction_resists_less(case: Case) -> None:
    found = [resistance(case, softened(case, mu)) for mu in (0.9, 0.7, 0.5, 0.3)]
    for name in ("Q_force", "Q_torque"):
        values = [figures[name] for figures in found]
        assert values == sorted(values, reverse=True)
        assert values[0] > 1.2 * values[2]
    assert resistance(case, softened(case, 0.2))["Q_force"] == 0.0  # too little for the load itself


def test_larger_footprints_resist_more(case: Case) -> None:
    """A ball, a can that lies along the pads, a box: a point, a line, an area, squeezed alike."""
    R = np.column_stack([case.jaw, np.cross(case.across, case.jaw), case.across])
    rpy = [math.atan2(R[2, 1], R[2, 2]), math.asin(-R[2, 0]), math.atan2(R[1, 0], R[0, 0])]
    pose = {"position": case.center.tolist(), "rpy": rpy}
    found = []
    for shape in (
        {"type": "sphere", "radius": case.radius},
        {"type": "cylinder", "radius": case.radius, "height": 0.05},
        {"type": "box", "size": [2 * case.radius, 0.05, 0.05]},
    ):
        given = softened(case).model_dump()
        given["objects"]["sphere"] = {"shape": shape, "pose": pose}
        found.append(resistance(case, Scene.model_validate(given)))
    point, line, area = (figures["Q_torque"] for figures in found)
    assert point < 0.9 * line
    assert line < 0.9 * area
    assert found[0]["Q_force"] <= found[1]["Q_force"] * (1 + 1e-6) <= found[2]["Q_force"] * (1 + 2e-6)


def test_a_heavier_object_is_accelerated_less(case: Case) -> None:
    """The mass is what the force weighs on Earth, if the object has none of its own."""
    given = softened(case).model_dump()
    found = {}
    for mass in (None, 2.0 / 9.80665, 1.0):
        given["objects"]["sphere"]["mass"] = mass
        found[mass] = resistance(case, Scene.model_validate(given))
    assert found[None] == pytest.approx(found[2.0 / 9.80665], rel=1e-9)
    assert found[1.0]["Q_force"] == pytest.approx(found[None]["Q_force"] * 2.0 / 9.80665, rel=1e-6)


def test_without_a_mass(case: Case) -> None:
    weightless = {"force": [0.0, 0.0, 0.0], "torque": [0.0, 0.0, 0.01]}
    assert resistance(case, softened(case, wrench=weightless)) == {}
    with pytest.raises(InputError, match=r"tasks\.sphere\.withstand: .*mass.*objects\.sphere\.mass"):
        Verifier(case.robot, softened(case, wrench=weightless, withstand=1.0), "sphere")


def test_a_task_says_what_is_to_be_withstood(case: Case) -> None:
    Q = resistance(case, softened(case))["Q_force"]
    assert "Q_force" not in {figure.name for figure in case.check(softened(case)).figures}
    for least, holds in ((0.99 * Q, True), (1.01 * Q, False)):
        certificate = case.check(softened(case, withstand=least))
        assert certificate["Q_force"].value == pytest.approx(Q)
        assert certificate["Q_force"].limit == least
        assert certificate["Q_torque"].limit == -math.inf
        assert names(certificate) == (set() if holds else {"Q_force"})


def test_numbers_that_are_not_finite(case: Case) -> None:
    assert all(math.isnan(value) for value in resistance(case, softened(case), points=np.full((2, 3), np.nan)).values())
    spoilt = case.check(softened(case, withstand=1.0), forces=np.full((2, 3), np.inf))
    assert {"Q_force", "Q_torque"} <= names(spoilt) | {"Q_torque"}
    assert math.isnan(spoilt["Q_torque"].value)


def test_the_hand_moves_its_pads_as_its_joints_say(case: Case) -> None:
    """Twists of the pads' links per unit of the synergy, beside a small motion of the driver and all that mimic it."""
    verifier, step = Verifier(case.robot, case.scene(), "sphere"), 1e-6

    def poses(opening: float) -> Any:
        moved = {
            joint.name: opening * joint.multiplier
            for joint in verifier._kinematics.joints
            if joint.mimics or joint.name == FINGERS
        }
        return verifier._kinematics.poses({**case.claim.joints, **moved})

    before, after = poses(OPENING - step), poses(OPENING + step)
    for pad, point in zip(case.robot.pads, case.claim.points, strict=True):
        twists = verifier._kinematics.twists(pad.link, poses(OPENING))
        [rate] = rate_of_twist(twists, verifier._rates)
        motion = (after[pad.link] @ np.linalg.inv(before[pad.link]) - np.eye(4)) / (2 * step)
        np.testing.assert_allclose(
            rate[:3] + np.cross(rate[3:], point), motion[:3, :3] @ point + motion[:3, 3], atol=1e-7
        )
        np.testing.assert_allclose(rate[3:], [motion[2, 1], motion[0, 2], motion[1, 0]], atol=1e-6)
