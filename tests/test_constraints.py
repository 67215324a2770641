"""Constraints and costs, each by itself: derivatives, values, names, and new ones from outside the package."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from typing import Any

import meshes
import numpy as np
import pinocchio as pin
import pytest
from conftest import TOY_SCENE, Array, RobotFactory, SceneFactory, agree, random_parameters
from places import Place, changed, first_grasp, project, random_starts
from test_synergies import OPEN_AND_SHIFT, TWO_SLIDERS

from pinograsp.collision.distances import REACH
from pinograsp.collision.pairs import PAD_CLEARANCE
from pinograsp.collision.scene_world import MARGIN_EXCESS
from pinograsp.descriptions import Scene
from pinograsp.kinematics.robot import Robot
from pinograsp.planning.assemble import claim_of
from pinograsp.problem import CONSTRAINTS, COSTS, Constraint, Cost, GraspProblem, Inside, Residual, State, TaskModel
from pinograsp.problem.constraint import PER_METRE, Kind, Projected, Violation
from pinograsp.problem.constraints.clearance import NEAR, SMOOTHING, Clearance, bend
from pinograsp.problem.constraints.contact_forces import ContactForces
from pinograsp.problem.constraints.pad_tangency import PadTangency
from pinograsp.problem.constraints.wrench_balance import UNBALANCED, WrenchBalance
from pinograsp.problem.costs.force_cost import saturated
from pinograsp.solve.projection import nearest_assignment
from pinograsp.verification.check import Verifier


@pytest.fixture(scope="module")
def soft_task(soft_gen3: Robot, glovebox: Scene) -> TaskModel:
    """Soft fingers, and a cone of approach directions that random postures miss."""
    cone = {"direction": (0.0, 0.6, -0.8), "angle": 0.05}
    return TaskModel(soft_gen3, changed(glovebox, "tasks", approach=cone), "sphere")


@pytest.fixture(scope="module")
def box_task(toy: Robot, make_toy_scene: SceneFactory) -> TaskModel:
    """The toy with a turned box between its fingers, the ball an obstacle; a wide cone about an axis of the box.

    Footprints are to be in the upper part of the box, contacts to keep off its edges.
    """
    objects = {
        "box": {
            "shape": {"type": "box", "size": [0.04, 0.05, 0.06]},
            "pose": {"position": [0.01, 0.0, 0.23], "rpy": [0.2, -0.3, 0.5]},
            "center_of_mass": [0.004, 0.002, -0.003],
        },
        "ball": {"shape": {"type": "sphere", "radius": 0.02}, "pose": {"position": [0.1, 0.05, 0.22]}},
    }
    task = TOY_SCENE["tasks"]["ball"] | {"object": "box", "desired_contacts": [[0.02, 0, 0], [-0.02, 0, 0]]}
    task |= {"approach": {"direction": [0, 0, 1], "angle": 1.2, "frame": "object"}, "reserve": {"rim": 0.003}}
    task |= {"allowed_contacts": {"type": "half_space", "normal": [0, 0, 1], "offset": -0.01}}
    return TaskModel(toy, make_toy_scene(objects=objects, tasks={"box": task}), "box")


@pytest.fixture(scope="module")
def curved_task(curved_gen3: Robot, glovebox: Scene) -> TaskModel:
    return TaskModel(curved_gen3, glovebox, "sphere")


@pytest.fixture(scope="module")
def mixed_task(mixed_toy: Robot, make_toy_scene: SceneFactory) -> TaskModel:
    return TaskModel(mixed_toy, make_toy_scene(), "ball")


@pytest.fixture(scope="module")
def limited_task(make_toy: RobotFactory, make_toy_scene: SceneFactory) -> TaskModel:
    """Two synergies that share both sliders, and contacts that must be in the upper part of the ball."""
    upper = {"type": "half_space", "normal": [0.0, 0.0, 1.0], "offset": 0.003}
    tasks = {"ball": TOY_SCENE["tasks"]["ball"] | {"allowed_contacts": upper, "contact_regions": "point"}}
    return TaskModel(make_toy(TWO_SLIDERS, hand=OPEN_AND_SHIFT), make_toy_scene(tasks=tasks), "ball")


@pytest.fixture(scope="module")
def line_task(gen3: Robot, can_scene: Scene) -> TaskModel:
    """Flat pads along a can, in the ring that is left of a band with a hole in it; contacts keep off the rims."""
    hole = {"type": "outside", "part": {"type": "ball", "center": (0.0, 0.0423, 0.03), "radius": 0.01}}
    region = {"type": "all_of", "parts": [{"type": "band", "z": (-0.02, 0.05)}, hole]}
    keys = {"allowed_contacts": region, "reserve": {"rim": 0.002}}
    return TaskModel(gen3, changed(can_scene, "tasks", "can", **keys), "can")


@pytest.fixture(scope="module")
def cone_task(gen3: Robot, can_scene: Scene) -> TaskModel:
    """Flat pads along a cone, whose lines turn as a contact moves around it, in a band; contacts keep off the rims."""
    shape = {"type": "cone", "bottom_radius": 0.042, "top_radius": 0.034, "height": 0.118}
    points = ((0.0, 0.038, 0.0), (0.0, -0.038, 0.0))
    keys = {"allowed_contacts": {"type": "band", "z": (-0.02, 0.05)}, "reserve": {"rim": 0.002}}
    scene = changed(can_scene, "objects", "can", shape=shape)
    return TaskModel(gen3, changed(scene, "tasks", "can", desired_contacts=points, **keys), "can")


@pytest.fixture(scope="module")
def ellipsoid_task(gen3: Robot, glovebox: Scene) -> TaskModel:
    scene = changed(glovebox, "objects", shape={"type": "ellipsoid", "semi_axes": (0.03, 0.0373, 0.035)})
    return TaskModel(gen3, scene, "sphere")


@pytest.fixture(scope="module")
def compound_task(gen3: Robot, can_scene: Scene) -> TaskModel:
    """Flat pads along a can with a lid and a leaning handle; contacts keep off the rims and what they run into."""
    handle = {"type": "box", "size": (0.03, 0.012, 0.06)}
    parts = [
        {"shape": {"type": "cylinder", "radius": 0.0423, "height": 0.1}},
        {"shape": {"type": "cylinder", "radius": 0.045, "height": 0.008}, "pose": {"position": (0.0, 0.0, 0.054)}},
        {"shape": handle, "pose": {"position": (0.05, 0.0, 0.0), "rpy": (0.3, 0.2, 0.1)}},
    ]
    scene = changed(can_scene, "objects", "can", shape={"type": "compound", "parts": parts})
    points, band = ((0.0, 0.0423, 0.0), (0.0, -0.0423, 0.0)), {"type": "band", "z": (-0.03, 0.04)}
    keys = {"desired_contacts": points, "allowed_contacts": band, "reserve": {"rim": 0.002}}
    return TaskModel(gen3, changed(scene, "tasks", "can", **keys), "can")


@pytest.fixture(scope="module")
def mesh_task(gen3: Robot, glovebox: Scene, tmp_path_factory: pytest.TempPathFactory) -> TaskModel:
    """A bottle as a mesh, on its side, held at its body near the shoulder."""
    file = meshes.written(meshes.bottle(), tmp_path_factory.mktemp("meshes") / "bottle.ply")
    pose = glovebox.objects["sphere"].pose.model_copy(update={"rpy": (1.4, 0.2, 0.3)})
    keys = {"shape": {"type": "mesh", "file": str(file), "unit": "m"}, "pose": pose.model_dump()}
    points = ((0.0, 0.03, 0.09), (0.0, -0.03, 0.09))
    scene = changed(changed(glovebox, "objects", **keys), "tasks", desired_contacts=points)
    return TaskModel(gen3, scene, "sphere")


@pytest.fixture(scope="module")
def mixed_mesh_task(
    mixed_toy: Robot, make_toy_scene: SceneFactory, tmp_path_factory: pytest.TempPathFactory
) -> TaskModel:
    """A ball as a mesh between fingers with curved pads."""
    file = meshes.written(
        meshes.ball(TOY_SCENE["objects"]["ball"]["shape"]["radius"]), tmp_path_factory.mktemp("meshes") / "ball.ply"
    )
    objects = {"ball": TOY_SCENE["objects"]["ball"] | {"shape": {"type": "mesh", "file": str(file), "unit": "m"}}}
    return TaskModel(mixed_toy, make_toy_scene(objects=objects), "ball")


TASKS = {"sphere_task": 3, "soft_task": 3, "toy_task": 3, "box_task": 3}  # seeds of each
TASKS |= {"paper_task": 1, "curved_task": 2, "mixed_task": 3, "limited_task": 3, "line_task": 2}
TASKS |= {"cone_task": 2, "ellipsoid_task": 1, "compound_task": 2}
TASKS |= {"mesh_task": 2, "mixed_mesh_task": 2}
WHERE = ["random", "near"]


@pytest.fixture(scope="module", params=[(t, w, s) for t, n in TASKS.items() for w in WHERE for s in range(n)], ids=str)
def place(request: pytest.FixtureRequest) -> Place:
    """Every task at random points and at points a little off a projected one."""
    name, where, seed = request.param
    model: TaskModel = request.getfixturevalue(name)
    rng = np.random.default_rng(seed)
    problem = GraspProblem(model, (0, 1))
    if model.robot.posture_size == 8:
        [posture] = random_starts(model, 1, seed + 1)
        x = np.concatenate([posture, random_parameters(model.robot, rng, 0.5)])
        problem = GraspProblem(model, nearest_assignment(model, problem.state(x)))
    else:
        x = rng.uniform(0.7 * problem.lower + 0.3 * problem.upper, 0.3 * problem.lower + 0.7 * problem.upper)
    if where == "near":
        x = project(problem, x, "contacts and clearance") + rng.normal(0.0, 1e-4, len(x))
    return Place(problem, x)


# ---- derivatives


def check_constraint(constraint: Constraint, place: Place) -> None:
    """Compare the Jacobians of a constraint with differences of its values."""
    problem = place.problem
    residual = constraint.residual(place.state)
    assert residual.values.shape == (len(constraint.rows),)
    agree(residual.jacobian, lambda x: constraint.residual(problem.state(x)).values, place.x, floor=1.0)
    check_projection(constraint, place)


def check_cost(cost: Cost, place: Place) -> None:
    value, gradient = cost.value(place.state)
    assert value >= 0.0
    agree(gradient, lambda x: cost.value(place.problem.state(x))[0], place.x, floor=1.0)
    check_projection(cost, place)


def check_projection(term: Constraint | Cost, place: Place) -> None:
    if isinstance(term, Projected):
        jacobian = term.projection(place.state, 0.3).jacobian
        agree(jacobian, lambda x: term.projection(place.problem.state(x), 0.3).values, place.x, floor=1.0)


def test_derivatives_of_every_constraint(place: Place) -> None:
    for constraint in place.problem.constraints:
        check_constraint(constraint, place)


def test_derivatives_of_every_cost(place: Place) -> None:
    for cost in place.problem.costs:
        check_cost(cost, place)


def test_every_constraint_and_cost_is_among_those_that_are_checked(request: pytest.FixtureRequest) -> None:
    models = [request.getfixturevalue(name) for name in TASKS]
    for make in (*CONSTRAINTS, *COSTS):
        assert any(make(model) is not None for model in models), make


def test_derivatives_of_the_assembled_problem(place: Place) -> None:
    problem, evaluation = place.problem, place.problem.evaluate(place.x)
    agree(evaluation.cost_gradient, lambda x: problem.evaluate(x).cost, place.x)
    agree(evaluation.equalities.jacobian, lambda x: problem.evaluate(x).equalities.values, place.x)
    agree(evaluation.inequalities.jacobian, lambda x: problem.evaluate(x).inequalities.values, place.x, floor=1.0)
    assert evaluation.equalities.values.shape == (len(problem.rows.equalities),)
    assert evaluation.inequalities.values.shape == (len(problem.rows.inequalities),)


def test_derivatives_of_the_residuals_of_the_projection(place: Place) -> None:
    for weights in ((1.0, 0.0), (0.3, 1.0), (0.0, 1.0)):
        residual = place.problem.projection_residual(place.x, *weights)
        agree(residual.jacobian, lambda x, w=weights: place.problem.projection_residual(x, *w).values, place.x)


# ---- values


@pytest.fixture(scope="module")
def grasp(sphere_task: TaskModel) -> Place:
    return first_grasp(sphere_task)


def test_saturated_V_is_V_where_the_limits_are_kept() -> None:
    strict = 5000.0
    assert saturated(2.18, strict) == (2.18, 1.0)
    for V in (strict * (1 - 1e-9), strict * (1 + 1e-9)):
        assert saturated(V, strict) == pytest.approx((strict, 1.0))
    for V in (1e4, 1e9):
        value, slope = saturated(V, strict)
        assert value < V
        assert slope == pytest.approx((saturated(V * 1.0001, strict)[0] - value) / (1e-4 * V), rel=1e-3)


def test_pad_tangency_tells_front_from_back(grasp: Place) -> None:
    """Pads swapped by assignment alone keep the geometry; turned by half a turn about the sphere they do not."""
    tangency = PadTangency(grasp.problem.model)
    np.testing.assert_allclose(tangency.sums(grasp.state).values, 0.0, atol=1e-5)
    back = copy.copy(grasp.state)
    back.__dict__["footprint"] = tuple(-part for part in grasp.state.footprint)
    np.testing.assert_allclose(np.linalg.norm(tangency.sums(back).values), 2 * math.sqrt(2), atol=1e-4)
    [violation] = tangency.violations(back)
    assert violation.value == pytest.approx(180.0, abs=0.1)
    assert violation.size == pytest.approx(1e3 * math.pi * 0.0373, rel=1e-3)  # the way along half the surface


def test_unbalanced_wrench_is_the_distance_of_the_weight_from_the_contact_line(place: Place) -> None:
    """For hard fingers: the torque about the line through both contacts, per weight and radius, up to second order."""
    state = place.state
    [value] = WrenchBalance(state.model).unbalanced(state).values
    if (state.model.contact_models.rows.spin >= 0).any():
        assert value == pytest.approx(0.0, abs=1e-9)
        return
    first, second = state.contacts.points
    load = state.model.load
    line = (second - first) / np.linalg.norm(second - first)
    torque = np.cross(load.center_of_mass - first, load.wrench[:3]) @ line
    arm = np.cross(first - load.center_of_mass, line) / load.rho
    expected = abs(torque) / load.rho / np.linalg.norm(load.wrench[:3]) / math.sqrt(1.0 + arm @ arm)
    assert value == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_slope_of_a_residual_that_is_zero_up_to_rounding(soft_task: TaskModel) -> None:
    """Two soft fingers balance every wrench; the value is about 1e-12 and its slope must not be of order one."""
    problem, balance = GraspProblem(soft_task, (0, 1)), WrenchBalance(soft_task)
    for posture in random_starts(soft_task, 3, 1):
        residual = balance.unbalanced(problem.state(np.concatenate([posture, np.full(4, 0.002)])))
        assert residual.values[0] < 1e-9
        np.testing.assert_allclose(residual.jacobian, 0.0, atol=1e-5)


def hard_fingers(gen3: Robot, glovebox: Scene, **keys: Any) -> TaskModel:
    return TaskModel(gen3, changed(glovebox, "tasks", contact_model={"model": "hard_finger"}, **keys), "sphere")


def test_balance_can_be_waived(gen3: Robot, glovebox: Scene) -> None:
    waived, wanted = (hard_fingers(gen3, glovebox, balance_wrench=balance) for balance in (False, True))
    without, kept = GraspProblem(waived, (0, 1)), GraspProblem(wanted, (0, 1))
    x = 0.5 * (kept.lower + kept.upper) + 0.1
    assert kept.rows.inequalities[1] == "wrench balance"
    assert without.rows.inequalities == kept.rows.inequalities[:1] + kept.rows.inequalities[2:]
    values = kept.evaluate(x).inequalities.values
    assert values[1] > 0.1
    np.testing.assert_array_equal(without.evaluate(x).inequalities.values, np.delete(values, 1))
    assert {"force balance", "torque balance"} & {found.name for found in kept.violations(kept.state(x))}
    assert not {"force balance", "torque balance"} & {found.name for found in without.violations(without.state(x))}


def test_the_larger_part_of_the_unbalanced_wrench_is_named(grasp: Place, gen3: Robot, glovebox: Scene) -> None:
    """Contacts far from the object leave a force; at the object, off its centre, a torque about their line."""
    problem = GraspProblem(hard_fingers(gen3, glovebox), grasp.problem.assignment)
    load = problem.model.load
    balance, weight = WrenchBalance(problem.model), float(np.linalg.norm(load.wrench[:3]))
    off_centre = grasp.x.copy()
    off_centre[-4:] += [0.003, 0.0, 0.003, 0.0]
    for x, name, unit, size in (
        (0.5 * (problem.lower + problem.upper) + 0.1, "force balance", "N", weight),
        (off_centre, "torque balance", "N mm", 1e3 * load.rho * weight),
    ):
        state = problem.state(x)
        relative = balance.unbalanced(state).values[0] - UNBALANCED
        assert relative > 0.0
        counts = pytest.approx(1e3 * load.rho * relative)
        assert balance.violations(state) == [Violation(name, pytest.approx(size * relative), unit, "", counts)]


def sigmas_of(state: State) -> list[float]:
    """Return (A1) to (A3) of all contacts, from forces, spin torques and normals, N."""
    limits, claim = state.model.limits, claim_of(state)
    found = []
    pads = state.model.robot.description.pads
    for pad, F, spin, normal in zip(pads, claim.forces, claim.spin_torques, state.grasp[1], strict=True):
        radius = getattr(pad.contact, "torsion_radius", math.inf)
        cone = math.cos(math.atan(limits.friction)) * math.hypot(*F, spin / radius)
        pressing = float(F @ normal)
        found += [cone - pressing, limits.minimum - pressing, math.hypot(*F) - limits.maximum]
    return found


def penalty(sigma: float, kappa: float) -> float:
    """Return 1 / (2 sigma^2) below -kappa; above, the parabola that has its value and both its derivatives there."""
    if sigma < -kappa:
        return 0.5 / sigma**2
    beyond = sigma + kappa
    return 0.5 / kappa**2 + beyond / kappa**3 + 1.5 * beyond**2 / kappa**4


@pytest.mark.parametrize(
    ("contact", "name"), [({"friction": 0.01}, "friction"), ({"friction": 50.0, "max_force": 0.9}, "force limit")]
)
def test_forces_are_blamed_on_the_limit_that_they_break(
    grasp: Place, gen3: Robot, glovebox: Scene, contact: dict[str, float], name: str
) -> None:
    before = glovebox.task("sphere").contact.model_dump()
    model = TaskModel(gen3, changed(glovebox, "tasks", contact=before | contact), "sphere")
    forces, state = ContactForces(model), GraspProblem(model, grasp.problem.assignment).state(grasp.x)
    [violation] = forces.violations(state)
    assert (violation.name, violation.unit) == (name, "N")
    assert violation.size == pytest.approx(forces.residual(state).values[0])
    assert violation.size > 1.0
    certificate = Verifier(gen3.description, model.scene, "sphere").check(claim_of(state))
    [broken] = [figure for figure in certificate.refuted_by if figure.name in forces.figures]
    assert broken.name == name
    # One term alone that is as large as all of V together has its sigma so far above -kappa.
    sigmas, kappa = sigmas_of(state), model.limits.kappa
    whole = sum(penalty(sigma, kappa) for sigma in sigmas)
    assert penalty(violation.value - kappa, kappa) == pytest.approx(whole, rel=1e-9)
    assert broken.value - broken.limit == pytest.approx(max(sigmas), abs=1e-5)
    assert ContactForces(grasp.problem.model).violations(grasp.state)[0].value == 0.0


@pytest.mark.parametrize(("pad", "term"), [(0, 0), (0, 1), (1, 1), (1, 2)])
def test_forces_are_blamed_on_the_largest_term(grasp: Place, pad: int, term: int) -> None:
    state = copy.copy(grasp.state)
    solution = state.forces
    assert solution.barrier.terms.sum() == pytest.approx(solution.V)
    terms = solution.barrier.terms.copy()
    terms[pad, term] = 1e9
    state.__dict__["forces"] = replace(solution, barrier=replace(solution.barrier, terms=terms))
    [violation] = ContactForces(state.model).violations(state)
    assert violation.name == ["friction", "normal force", "force limit"][term]
    assert violation.where == ["left", "right"][pad]


# ---- clearance


def test_bent_distance_is_smooth() -> None:
    """phi is d up to NEAR, constant from REACH on, and in between rises with a slope that falls from 1 to 0."""

    def bent(d: Array) -> tuple[Array, Array]:
        values, slopes = zip(*(bend(value, REACH) for value in d.tolist()), strict=True)
        return np.array(values), np.array(slopes)

    d = np.linspace(-0.02, 0.08, 2001)
    values, slopes = bent(d)
    np.testing.assert_array_equal(values[d <= NEAR], d[d <= NEAR])
    np.testing.assert_allclose(values[d >= REACH], 0.5 * (NEAR + REACH), atol=1e-15)
    numeric = (bent(d + 1e-7)[0] - bent(d - 1e-7)[0]) / 2e-7
    np.testing.assert_allclose(slopes, numeric, atol=1e-6)
    assert (np.diff(slopes) <= 1e-12).all()
    curvatures = (bent(np.array([NEAR, REACH]) + 1e-7)[1] - bent(np.array([NEAR, REACH]) - 1e-7)[1]) / 2e-7
    np.testing.assert_allclose(curvatures, 0.0, atol=1e-2)


def test_clearance_is_a_tight_lower_bound(place: Place) -> None:
    """Of what every link's least distance has above its margin, bent; violations are of the unbent least."""
    state = place.state
    model, measured = state.model, state.distances
    clearance, margin = Clearance(model), model.task.margin
    margins = dict.fromkeys(("enclosure clearance", "obstacle clearance"), margin.enclosure + MARGIN_EXCESS)
    margins |= {"self clearance": margin.robot + MARGIN_EXCESS, "object clearance": margin.object + MARGIN_EXCESS}
    least = dict.fromkeys(clearance.links, math.inf)
    known = dict(zip(measured.indices.tolist(), measured.values.tolist(), strict=True))
    violated: dict[str, float] = {}
    for index, pair in enumerate(model.collisions.pairs):
        if pair.kind == PAD_CLEARANCE:
            continue  # another constraint's
        d = known.get(index, math.inf)
        bent, _ = bend(min(d - margins[pair.kind], REACH), REACH)
        least[pair.link] = min(least[pair.link], bent)
        if index in known:
            violated[pair.kind] = max(violated.get(pair.kind, 0.0), 1e3 * (margins[pair.kind] - d))
    slack = np.array(list(least.values())) - clearance.inside(state).values
    assert (slack >= -1e-12).all()
    assert (slack <= SMOOTHING * math.log(len(model.collisions.pairs)) + 1e-12).all()
    assert {found.name: found.value for found in clearance.violations(state)} == pytest.approx(violated)


def test_margin_larger_than_the_reach_can_be_kept(gen3: Robot, glovebox: Scene) -> None:
    wide = changed(glovebox, "tasks", margin={"enclosure": 2 * REACH, "robot": 0.005})
    model = TaskModel(gen3, wide, "sphere")
    clearance = Clearance(model)
    stretched = np.array([0.0, 0.3, 0.0, -0.6, 0.0, 0.3, 0.0, 0.4, 0.0, 0.0, 0.0, 0.0])
    state = GraspProblem(model, (0, 1)).state(stretched)
    links = dict(zip(clearance.links, clearance.inside(state).values.tolist(), strict=True))
    assert links["shoulder_link"] > 0.4 * (NEAR + REACH)
    violations = {violation.name: violation.value for violation in clearance.violations(state)}
    assert violations["enclosure clearance"] == pytest.approx(-1e3 * min(links.values()), abs=2.0)


# ---- names


UNITS = {"mm": "m", "deg": "rad", "N": "N", "N mm": "N m"}
"""Units of figures by those of violations; a violation without a unit is relative."""


@pytest.mark.parametrize("name", TASKS)
def test_violations_are_named_as_figures_of_the_certificate(name: str, request: pytest.FixtureRequest) -> None:
    model: TaskModel = request.getfixturevalue(name)
    problem, verifier = GraspProblem(model, (0, 1)), Verifier(model.robot.description, model.scene, model.task_name)
    rng = np.random.default_rng(0)
    low, high = np.maximum(problem.lower, -math.pi), np.minimum(problem.upper, math.pi)
    seen = set()
    for x in rng.uniform(low, high, (5, len(low))):
        state = problem.state(x)
        figures = {figure.name: figure.unit for figure in verifier.check(claim_of(state)).figures}
        for violation in problem.violations(state):
            assert violation.value >= 0.0
            assert UNITS.get(violation.unit, figures[violation.name]) == figures[violation.name]
            seen.add((violation.name, violation.unit))
    assert {"contact gap", "pad tangency"} < {name for name, _ in seen}
    assert seen <= {item for constraint in problem.constraints for item in constraint.figures.items()}


def test_figures_of_constraints_are_in_some_certificate(request: pytest.FixtureRequest) -> None:
    known: set[str] = set()
    declared: set[str] = set()
    for name in TASKS:
        model: TaskModel = request.getfixturevalue(name)
        problem, verifier = GraspProblem(model, (0, 1)), Verifier(model.robot.description, model.scene, model.task_name)
        claim = claim_of(problem.state(0.5 * (problem.lower + problem.upper)))
        known |= {figure.name for figure in verifier.check(claim).figures}
        declared |= {figure for constraint in problem.constraints for figure in constraint.figures}
    assert declared <= known


def test_names_of_rows(limited_task: TaskModel) -> None:
    rows = GraspProblem(limited_task, (0, 1)).rows
    assert rows.equalities[:3] == ("contact gap of left", "contact gap of right", "pad tangency of left, x")
    assert rows.inequalities[:5] == (
        "contact forces",
        "wrench balance",
        "contact region of left",
        "contact region of right",
        "upper limit of slide_left",
    )
    assert rows.inequalities[8:] == ("clearance of arm", "clearance of left", "clearance of right")
    assert len(set(rows.equalities + rows.inequalities)) == len(rows.equalities + rows.inequalities)


# ---- constraints and costs from outside the package


class WristHeight(Inside):
    """The wrist is at least so high, m."""

    name = "wrist height"
    figures = {"wrist height": "mm"}  # noqa: RUF012
    rows = ("wrist height",)
    scale = PER_METRE

    def __init__(self, model: TaskModel) -> None:
        self._wrist = model.robot.description.arm.wrist
        self.least = model.load.center_of_mass[2] + 0.1

    def inside(self, state: State) -> Residual:
        configuration = state.configuration
        robot = configuration.robot
        frame = robot.model.frames[robot.wrist_frame]
        joint = frame.parentJoint
        place = configuration.translations[joint] + configuration.rotations[joint] @ frame.placement.translation
        moved = configuration.jacobian[:3] + np.cross(configuration.jacobian[3:], place, axis=0)
        jacobian = np.zeros((1, len(state.x)))
        jacobian[0, : robot.posture_size] = (moved[2] * robot.supports[joint]) @ robot.B
        return Residual(place[2:], jacobian)

    def violations(self, state: State) -> list[Violation]:
        below = max(0.0, 1e3 * (self.least - float(self.inside(state).values[0])))
        return [Violation("wrist height", below, "mm", self._wrist, size=below)]


class WristAtHeight(WristHeight):
    name = "wrist at height"
    kind: Kind = "equality"


class Opening(Cost):
    """Square of the last synergy: a hand that is nearly closed is preferred."""

    name = "opening"

    def __init__(self, model: TaskModel) -> None:
        self._index = model.robot.posture_size - 1

    def value(self, state: State) -> tuple[float, Array]:
        slope = np.zeros(len(state.x))
        slope[self._index] = 2.0 * state.x[self._index]
        return float(state.x[self._index] ** 2), slope


def test_a_constraint_from_outside(place: Place) -> None:
    model, x = place.problem.model, place.x
    problem = GraspProblem(model, place.problem.assignment, constraints=(*CONSTRAINTS, WristHeight))
    [constraint] = [c for c in problem.constraints if isinstance(c, WristHeight)]
    check_constraint(constraint, Place(problem, x))
    assert problem.rows.inequalities == (*place.problem.rows.inequalities, "wrist height")
    before, after = place.problem.evaluate(x), problem.evaluate(x)
    np.testing.assert_array_equal(after.inequalities.values[:-1], before.inequalities.values)
    below = constraint.least - _wrist_height(model, x)
    assert after.inequalities.values[-1] == pytest.approx(100.0 * below)
    with_it, without = (np.linalg.norm(p.projection_residual(x, 1.0, 0.0).values) for p in (problem, place.problem))
    assert with_it**2 - without**2 == pytest.approx((100.0 * max(0.0, below)) ** 2, rel=1e-6, abs=1e-9 * without**2)
    wrist = model.robot.description.arm.wrist
    value = pytest.approx(max(0.0, 1e3 * below))
    expected = Violation("wrist height", value, "mm", wrist, size=value)
    assert problem.violations(problem.state(x))[-1] == expected


def test_an_equality_from_outside(sphere_task: TaskModel, grasp: Place) -> None:
    """Its row is one more of those that the solver is given as independent."""
    problem = GraspProblem(sphere_task, grasp.problem.assignment, constraints=(*CONSTRAINTS, WristAtHeight))
    plain, more = (p.equality_basis(p.evaluate(grasp.x)) for p in (grasp.problem, problem))
    assert problem.rows.equalities == (*grasp.problem.rows.equalities, "wrist height")
    assert more.shape == (plain.shape[0] + 1, plain.shape[1] + 1)
    assert np.linalg.matrix_rank(more) == len(more)
    check_constraint(problem.constraints[-1], Place(problem, grasp.x))


def test_a_cost_from_outside(place: Place) -> None:
    problem = GraspProblem(place.problem.model, place.problem.assignment, costs=(*COSTS, Opening))
    check_cost(problem.costs[-1], place)
    before, after = place.problem.evaluate(place.x), problem.evaluate(place.x)
    last = place.x[place.problem.model.robot.posture_size - 1]
    assert after.cost == pytest.approx(before.cost + 1e-3 * last**2)


def _wrist_height(model: TaskModel, x: Array) -> float:
    data = model.robot.model.createData()
    pin.framesForwardKinematics(model.robot.model, data, model.robot.joint_positions(x[: model.robot.posture_size]))
    return float(data.oMf[model.robot.wrist_frame].translation[2])
