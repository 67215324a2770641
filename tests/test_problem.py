"""Terms and their derivatives, the assembled problem, checks of a task, and the projection of starts."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from conftest import TOY_SCENE, Array, SceneFactory, agree, random_parameters
from pinograsp.problem.assembly import COST_SCALE, _saturated
from pinograsp.problem.terms.clearance import NEAR, SMOOTHING, bend

from pinograsp.collision.batch_clearance import BatchClearance
from pinograsp.collision.distances import REACH
from pinograsp.collision.scene_world import SLACK, enclosure_world
from pinograsp.descriptions import SceneDescription
from pinograsp.errors import InputError
from pinograsp.kinematics.hand_posture import preshape, synergy_postures, widest_jaw
from pinograsp.kinematics.robot import RobotModel
from pinograsp.problem import GraspProblem, State, TaskModel, check_task
from pinograsp.problem.terms import (
    Residual,
    approach,
    contact_gap,
    desired_contacts,
    facing,
    force_cost,
    unbalanced_wrench,
)
from pinograsp.solve.projection import Projection, _damped_step, initial_guesses, nearest_assignment

TERMS: dict[str, Callable[[GraspProblem], Callable[[State], Residual]]] = {
    "contact_gap": lambda _: contact_gap,
    "facing": lambda _: facing,
    "desired_contacts": lambda _: desired_contacts,
    "force_cost": lambda _: force_cost,
    "unbalanced_wrench": lambda _: unbalanced_wrench,
    "approach": lambda _: approach,
    "clearance": lambda problem: problem.clearance,
}
SIZES = {"contact_gap": 2, "facing": 6, "desired_contacts": 6}
SIZES |= {"force_cost": 1, "unbalanced_wrench": 1, "approach": 1}


@functools.cache
def random_starts(model: TaskModel, count: int, seed: int) -> Array:
    """Return postures free of collision with the wrist near the object, the hand opened for the desired points."""
    normals = -model.object_surface(model.desired_points)[1]
    robot, synergies = model.robot, preshape(model.robot, model.desired_points, normals)
    low, high = np.maximum(robot.lower[:-1], -math.pi), np.minimum(robot.upper[:-1], math.pi)
    q = np.random.default_rng(seed).uniform(low, high, (30_000, len(low)))
    clearance = BatchClearance(robot, enclosure_world(robot, model.scene, model.task.margin), synergies)
    positions, _ = clearance.kinematics.wrist(clearance.kinematics.frames(q))
    q = q[np.linalg.norm(positions - model.load.center_of_mass, axis=1) < 0.3]
    q = q[clearance.measure(q)[0]][:count]
    return np.column_stack([q, np.tile(synergies, (len(q), 1))])


def project(problem: GraspProblem, x: Array, onto: Projection) -> Array:
    """Return the first point to solve from."""
    return next(initial_guesses(problem, x, onto))


@pytest.fixture(scope="module")
def soft_task(soft_gen3: RobotModel, glovebox: SceneDescription) -> TaskModel:
    """Soft fingers, and a cone of approach directions that random postures miss."""
    cone = {"direction": (0.0, 0.6, -0.8), "angle": 0.05}
    return TaskModel(soft_gen3, changed(glovebox, "tasks", approach=cone), "sphere")


@pytest.fixture(scope="module")
def box_task(toy: RobotModel, make_toy_scene: SceneFactory) -> TaskModel:
    """The toy with a turned box between its fingers, the ball an obstacle; a wide cone about an axis of the box."""
    objects = {
        "box": {
            "shape": {"type": "box", "size": [0.04, 0.05, 0.06]},
            "pose": {"position": [0.01, 0.0, 0.23], "rpy": [0.2, -0.3, 0.5]},
            "center_of_mass": [0.004, 0.002, -0.003],
        },
        "ball": {"shape": {"type": "sphere", "radius": 0.02}, "pose": {"position": [0.1, 0.05, 0.22]}},
    }
    task = TOY_SCENE["tasks"]["ball"] | {"object": "box", "desired_contacts": [[0.02, 0, 0], [-0.02, 0, 0]]}
    task |= {"approach": {"direction": [0, 0, 1], "angle": 1.2, "frame": "object"}}
    return TaskModel(toy, make_toy_scene(objects=objects, tasks={"box": task}), "box")


@pytest.fixture(scope="module")
def curved_task(curved_gen3: RobotModel, glovebox: SceneDescription) -> TaskModel:
    return TaskModel(curved_gen3, glovebox, "sphere")


@pytest.fixture(scope="module")
def mixed_task(mixed_toy: RobotModel, make_toy_scene: SceneFactory) -> TaskModel:
    return TaskModel(mixed_toy, make_toy_scene(), "ball")


@dataclass(frozen=True)
class Place:
    """A point of a problem."""

    problem: GraspProblem
    x: Array

    @property
    def state(self) -> State:
        return self.problem.state(self.x)


TASKS = {"sphere_task": 3, "soft_task": 3, "toy_task": 3, "box_task": 3}  # seeds of each
TASKS |= {"paper_task": 1, "curved_task": 2, "mixed_task": 3}
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


@pytest.mark.parametrize("name", TERMS)
def test_derivatives_of_terms(place: Place, name: str) -> None:
    term = TERMS[name](place.problem)
    residual = term(place.state)
    if name == "approach" and place.problem.model.approach is None:
        assert residual.jacobian.shape == (0, len(place.x))
        return
    assert residual.values.shape == (SIZES.get(name, len(place.problem.clearance.links)),)
    if name == "unbalanced_wrench" and residual.values[0] < 1e-9:
        assert place.state.model.contact_models.rows.spin.tolist() == [3, 7]
        return  # rounding errors alone: below
    agree(residual.jacobian, lambda x: term(place.problem.state(x)).values, place.x)


def test_slope_of_a_residual_that_is_zero_up_to_rounding(soft_task: TaskModel) -> None:
    """Two soft fingers balance every wrench; the value is about 1e-12 and its slope must not be of order one."""
    problem = GraspProblem(soft_task, (0, 1))
    for posture in random_starts(soft_task, 3, 1):
        residual = unbalanced_wrench(problem.state(np.concatenate([posture, np.full(4, 0.002)])))
        assert residual.values[0] < 1e-9
        np.testing.assert_allclose(residual.jacobian, 0.0, atol=1e-5)


def test_derivatives_of_the_assembled_problem(place: Place) -> None:
    problem, evaluation = place.problem, place.problem.evaluate(place.x)
    agree(evaluation.cost_gradient, lambda x: problem.evaluate(x).cost, place.x)
    agree(evaluation.equalities.jacobian, lambda x: problem.evaluate(x).equalities.values, place.x)
    agree(evaluation.inequalities.jacobian, lambda x: problem.evaluate(x).inequalities.values, place.x, floor=1.0)
    assert evaluation.equalities.values.shape == (4 * len(problem.model.robot.pads),)
    assert evaluation.inequalities.values.shape == (problem.inequality_count,)


def test_derivatives_of_the_residuals_of_the_projection(place: Place) -> None:
    for weights in ((1.0, 0.0), (0.3, 1.0), (0.0, 1.0)):
        residual = place.problem.projection_residual(place.x, *weights)
        agree(residual.jacobian, lambda x, w=weights: place.problem.projection_residual(x, *w).values, place.x)


# ---- values


@pytest.fixture(scope="module")
def grasp(sphere_task: TaskModel) -> Place:
    """A grasp of the sphere at the desired points: the first projected start that keeps every constraint."""
    for posture in random_starts(sphere_task, 20, 0):
        x = np.concatenate([posture, np.zeros(4)])
        problem = GraspProblem(sphere_task, (0, 1))
        problem = GraspProblem(sphere_task, nearest_assignment(sphere_task, problem.state(x)))
        x = project(problem, x, "contacts and clearance")
        if problem.evaluate(x).violation < 1e-4:
            return Place(problem, x)
    raise AssertionError("no start leads to a grasp")


def test_a_grasp_at_the_desired_points(grasp: Place) -> None:
    """Contacts, normals and costs of a grasp as they follow from the sphere alone; U = V* = 2.1787."""
    state, evaluation = grasp.state, grasp.problem.evaluate(grasp.x)
    assert pytest.approx(2.1787, abs=1e-4) == state.forces.V
    assert evaluation.cost == pytest.approx(COST_SCALE * 2.1787, abs=1e-6)
    np.testing.assert_allclose(state.contacts.points, state.desired, atol=1e-6)
    center = state.model.load.center_of_mass
    np.testing.assert_allclose(state.contacts.normals, (center - state.contacts.points) / 0.0373, atol=1e-4)
    assert {name: value for name, (value, _) in grasp.problem.violations(state).items() if value > 1e-3} == {}


def test_cost_is_squared_offsets_in_millimetres_and_weighted_V(grasp: Place) -> None:
    x = grasp.x.copy()
    x[-4:] += [0.003, 0.001, -0.002, 0.0]
    state = grasp.problem.state(x)
    phi = 1e6 * ((state.contacts.points - state.desired) ** 2).sum()
    weight = state.model.task.force_weight
    assert phi == pytest.approx(14.0, rel=1e-3)
    assert grasp.problem.evaluate(x).cost == pytest.approx(COST_SCALE * (phi + weight * state.forces.V))


def test_saturated_V_is_V_where_the_limits_are_kept() -> None:
    strict = 5000.0
    assert _saturated(2.18, strict) == (2.18, 1.0)
    for V in (strict * (1 - 1e-9), strict * (1 + 1e-9)):
        assert _saturated(V, strict) == pytest.approx((strict, 1.0))
    for V in (1e4, 1e9):
        value, slope = _saturated(V, strict)
        assert value < V
        assert slope == pytest.approx((_saturated(V * 1.0001, strict)[0] - value) / (1e-4 * V), rel=1e-3)


def test_facing_tells_front_from_back(grasp: Place) -> None:
    """Pads swapped by assignment alone keep the geometry; turned by half a turn about the sphere they do not."""
    np.testing.assert_allclose(facing(grasp.state).values, 0.0, atol=1e-5)
    back = grasp.state
    back.__dict__["surface"] = tuple(sign * part for sign, part in zip((1, -1, -1), grasp.state.surface, strict=True))
    np.testing.assert_allclose(np.linalg.norm(facing(back).values), 2 * math.sqrt(2), atol=1e-4)


def test_unbalanced_wrench_is_the_distance_of_the_weight_from_the_contact_line(place: Place) -> None:
    """For hard fingers: the torque about the line through both contacts, per weight and radius, up to second order."""
    state = place.state
    if (state.model.contact_models.rows.spin >= 0).any():
        np.testing.assert_allclose(unbalanced_wrench(state).values, 0.0, atol=1e-9)
        return
    first, second = state.contacts.points
    load = state.model.load
    line = (second - first) / np.linalg.norm(second - first)
    torque = np.cross(load.center_of_mass - first, load.wrench[:3]) @ line
    arm = np.cross(first - load.center_of_mass, line) / load.rho
    expected = abs(torque) / load.rho / np.linalg.norm(load.wrench[:3]) / math.sqrt(1.0 + arm @ arm)
    [value] = unbalanced_wrench(state).values
    assert value == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_balance_can_be_waived(sphere_task: TaskModel, gen3: RobotModel, glovebox: SceneDescription) -> None:
    scene = changed(glovebox, "tasks", balance_wrench=False)
    waived = GraspProblem(TaskModel(gen3, scene, "sphere"), (0, 1))
    kept = GraspProblem(sphere_task, (0, 1))
    x = 0.5 * (kept.lower + kept.upper) + 0.1
    difference = kept.evaluate(x).inequalities.values - waived.evaluate(x).inequalities.values
    assert difference[1] > 0.1
    np.testing.assert_array_equal(np.delete(difference, 1), 0.0)
    assert waived.evaluate(x).inequalities.values[1] == 0.0
    assert kept.violations(kept.state(x))["balance"][0] > 0.0
    assert waived.violations(waived.state(x))["balance"][0] == 0.0


def test_violations_are_in_millimetres(grasp: Place) -> None:
    """The finger joint opened a little: gap and place as the contact points tell; a pad's name goes with it."""
    x = grasp.x.copy()
    x[7] -= 0.05
    problem, state = grasp.problem, grasp.problem.state(x)
    gaps = 1e3 * np.abs(np.linalg.norm(state.contacts.points - state.model.load.center_of_mass, axis=1) - 0.0373)
    found = problem.violations(state)
    assert gaps.max() > 1.0
    assert found["contact"] == (pytest.approx(gaps.max()), ["left", "right"][int(gaps.argmax())])
    assert problem.evaluate(x).violation >= 0.1 * gaps.max() * (1 - 1e-9)


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
    """Of what every link's least distance has above its margin, bent; `worst` gives the unbent least."""
    problem, state = place.problem, place.state
    model, measured = state.model, state.distances
    margin = model.task.margin
    margins = {"enclosure": margin.enclosure + SLACK, "self": margin.robot + SLACK, "object": 0.0}
    least = dict.fromkeys(problem.clearance.links, math.inf)
    known = dict(zip(measured.indices.tolist(), measured.values.tolist(), strict=True))
    worst: dict[str, float] = {}
    for index, pair in enumerate(model.collisions.pairs):
        d = known.get(index, math.inf)
        bent, _ = bend(min(d - margins[pair.kind], REACH), REACH)
        least[pair.link] = min(least[pair.link], bent)
        if index in known:
            worst[pair.kind] = min(worst.get(pair.kind, math.inf), d - margins[pair.kind])
    values = problem.clearance(state).values
    slack = np.array(list(least.values())) - values
    assert (slack >= -1e-12).all()
    assert (slack <= SMOOTHING * math.log(len(model.collisions.pairs)) + 1e-12).all()
    assert {kind: value for kind, (value, _) in problem.clearance.worst(state).items()} == pytest.approx(worst)


def test_margin_larger_than_the_reach_can_be_kept(gen3: RobotModel, glovebox: SceneDescription) -> None:
    wide = changed(glovebox, "tasks", margin={"enclosure": 2 * REACH, "robot": 0.005})
    problem = GraspProblem(TaskModel(gen3, wide, "sphere"), (0, 1))
    stretched = np.array([0.0, 0.3, 0.0, -0.6, 0.0, 0.3, 0.0, 0.4, 0.0, 0.0, 0.0, 0.0])
    state = problem.state(stretched)
    links = dict(zip(problem.clearance.links, problem.clearance(state).values.tolist(), strict=True))
    assert links["shoulder_link"] > 0.4 * (NEAR + REACH)
    assert problem.clearance.worst(state)["enclosure"][0] == pytest.approx(min(links.values()), abs=2e-3)


# ---- checks of a task


def changed(scene: SceneDescription, section: str, name: str = "sphere", **keys: Any) -> SceneDescription:
    """Return the scene with keys of one object or task replaced."""
    content = scene.model_dump()
    content[section][name] |= keys
    return SceneDescription.model_validate(content)


def refused(robot: RobotModel, scene: SceneDescription, key: str) -> InputError:
    with pytest.raises(InputError) as caught:
        check_task(TaskModel(robot, scene, "sphere"))
    assert caught.value.file == scene.source
    assert caught.value.key == key
    assert str(scene.source) in str(caught.value)
    assert caught.value.remedy
    return caught.value


def test_the_shipped_task_is_accepted(sphere_task: TaskModel) -> None:
    check_task(sphere_task)


def test_object_outside_the_enclosure(gen3: RobotModel, glovebox: SceneDescription) -> None:
    """5.3 mm above the floor's height of -0.237 m less radius: 1.6 mm through it, then 37.3 mm outside a side wall."""
    below = changed(glovebox, "objects", pose={"position": (0.801, 0.020, -0.2013)})
    assert "1.6 mm beyond wall z=-0.237" in refused(gen3, below, "objects.sphere.pose").problem
    beside = changed(glovebox, "objects", pose={"position": (0.801, 0.42, 0.0)})
    assert "37.3 mm beyond wall y=0.42" in refused(gen3, beside, "objects.sphere.pose").problem


@pytest.mark.parametrize(("y", "side"), [(0.0380, "0.7 mm outside"), (0.0363, "1.0 mm inside")])
def test_desired_contact_off_the_surface(gen3: RobotModel, glovebox: SceneDescription, y: float, side: str) -> None:
    scene = changed(glovebox, "tasks", desired_contacts=((0.0, 0.0373, 0.0), (0.0, -y, 0.0)))
    assert side in refused(gen3, scene, "tasks.sphere.desired_contacts[1]").problem


def test_one_desired_contact_for_each_pad(gen3: RobotModel, glovebox: SceneDescription) -> None:
    r = 0.0373
    scene = changed(glovebox, "tasks", desired_contacts=((0.0, r, 0.0), (0.0, -r, 0.0), (r, 0.0, 0.0)))
    assert "3 desired contacts for a hand of 2 pads" in refused(gen3, scene, "tasks.sphere.desired_contacts").problem


def test_object_wider_than_the_jaw(gen3: RobotModel, glovebox: SceneDescription) -> None:
    r = 0.045
    scene = changed(glovebox, "objects", shape={"type": "sphere", "radius": r}, pose={"position": (0.8, 0.0, 0.0)})
    scene = changed(scene, "tasks", desired_contacts=((0.0, r, 0.0), (0.0, -r, 0.0)))
    problem = refused(gen3, scene, "objects.sphere.shape").problem
    assert "85.0 mm" in problem
    assert "90.0 mm" in problem


# ---- the hand before a grasp


def test_the_2f85_opens_85_millimetres(gen3: RobotModel) -> None:
    widest = widest_jaw(gen3)
    assert widest is not None
    assert 1e3 * widest == pytest.approx(85.0, abs=0.1)


def test_widest_jaw_of_the_toy_is_the_sum_of_its_strokes(toy: RobotModel) -> None:
    assert widest_jaw(toy) == pytest.approx(0.06 + 1.25 * 0.06 + 0.002)


@pytest.mark.parametrize("apart", [0.0, 0.03, 0.0746, 0.2])
def test_preshape_holds_the_pads_as_far_apart_as_the_points(gen3: RobotModel, apart: float) -> None:
    points, normals = np.array([[0.0, 0.0, 0.0], [0.0, apart, 0.0]]), np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    chosen = preshape(gen3, points, normals)
    widths = {float(s[0]): np.linalg.norm(pads.points[0] - pads.points[1]) for s, pads in synergy_postures(gen3)}
    assert min(widths) == 0.0
    assert max(widths) == pytest.approx(0.8)
    assert abs(widths[float(chosen[0])] - apart) == min(abs(width - apart) for width in widths.values())
    if apart < 0.085:
        assert abs(widths[float(chosen[0])] - apart) < 0.003


# ---- projection


def test_assignment_follows_the_pads(grasp: Place) -> None:
    """A pad serves the desired point that it touches, also when the points are listed the other way round."""
    model, state = grasp.state.model, grasp.state
    assert nearest_assignment(model, state) == grasp.problem.assignment
    offsets = state.contacts.points - model.desired_points[list(grasp.problem.assignment)]
    assert np.abs(offsets).max() < 1e-4
    other = tuple(reversed(grasp.problem.assignment))
    swapped = GraspProblem(model, other)
    far = desired_contacts(swapped.state(grasp.x)).values.reshape(-1, 3)
    np.testing.assert_allclose(np.linalg.norm(far, axis=1), 2 * 0.0373, atol=1e-4)


@pytest.fixture(scope="module")
def starts(sphere_task: TaskModel) -> list[Place]:
    places = []
    for posture in random_starts(sphere_task, 20, 7):
        x = np.concatenate([posture, np.zeros(4)])
        problem = GraspProblem(sphere_task, (0, 1))
        places.append(Place(GraspProblem(sphere_task, nearest_assignment(sphere_task, problem.state(x))), x))
    assert len(places) == 20
    return places


def test_projection_makes_contact(starts: list[Place]) -> None:
    made = 0
    for start in starts:
        x = project(start.problem, start.x, "contacts")
        assert (x >= start.problem.lower).all()
        assert (x <= start.problem.upper).all()
        before, after = (np.linalg.norm(start.problem.projection_residual(v, 1.0, 0.0).values) for v in (start.x, x))
        assert before > 1.0
        made += after < 1e-4
    assert made >= 18


def test_projection_with_clearances_reduces_what_is_violated(starts: list[Place]) -> None:
    """The second stage never ends with a greater residual than the first, and frees some start from collision."""
    freed = 0
    for start in starts:
        first, second = (project(start.problem, start.x, stage) for stage in ("contacts", "contacts and clearance"))
        residuals = [np.linalg.norm(start.problem.projection_residual(x, 0.0, 1.0).values) for x in (first, second)]
        assert residuals[1] <= residuals[0]
        freed += residuals[1] < 1e-4 < 1e-2 < residuals[0]
    assert freed >= 1


def test_no_projection_returns_the_start(starts: list[Place]) -> None:
    np.testing.assert_array_equal(project(starts[0].problem, starts[0].x, "nothing"), starts[0].x)


def test_projection_from_a_corner_of_the_bounds(toy_task: TaskModel) -> None:
    """Every variable at a bound: steps that push outwards are dropped, the others still reach contact."""
    problem = GraspProblem(toy_task, (0, 1))
    for corner in (problem.lower, problem.upper):
        x = project(problem, corner.copy(), "contacts")
        assert (x >= problem.lower).all()
        assert (x <= problem.upper).all()
        before, after = (np.linalg.norm(problem.projection_residual(v, 1.0, 0.0).values) for v in (corner, x))
        assert after < 0.5 * before


def test_steps_never_leave_a_bound_outwards() -> None:
    """And are, over the variables that do not push against their bound, the damped least-squares step."""
    rng = np.random.default_rng(0)
    held = 0
    for _ in range(50):
        J, values, at_bound = rng.normal(size=(6, 5)), rng.normal(size=6), rng.integers(-1, 2, 5).astype(float)
        step = _damped_step(J, values, 0.1, at_bound)
        assert (step * at_bound <= 0.0).all()
        free = step != 0.0
        held += int((~free).sum())
        normal = J[:, free].T @ J[:, free] + 0.1 * np.eye(int(free.sum()))
        np.testing.assert_allclose(normal @ step[free], -J[:, free].T @ values, atol=1e-12)
    assert held > 20
