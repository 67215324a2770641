"""The assembled problem, checks of a task, and the projection of starts."""

from __future__ import annotations

import numpy as np
import pytest
from places import Place, changed, first_grasp, project, random_starts

from pinograsp import Body, Box, Object, Pose, Sphere
from pinograsp.descriptions import Scene
from pinograsp.errors import InputError, TaskError
from pinograsp.kinematics.hand_posture import jaw_range, preshape, synergy_postures
from pinograsp.kinematics.robot import Robot
from pinograsp.problem import GraspProblem, TaskModel, Violation, check_placement, check_task
from pinograsp.problem.problem import COST_SCALE, KEPT
from pinograsp.solve.projection import damped_step, nearest_assignment
from pinograsp.solve.recorder import Recorder, program_from


@pytest.fixture(scope="module")
def grasp(sphere_task: TaskModel) -> Place:
    return first_grasp(sphere_task)


# ---- values


def test_a_grasp_at_the_desired_points(grasp: Place) -> None:
    """Contacts, normals and costs of a grasp as they follow from the sphere alone; U = V* = 2.1787."""
    state, evaluation = grasp.state, grasp.problem.evaluate(grasp.x)
    assert pytest.approx(2.1787, abs=1e-4) == state.forces.V
    assert evaluation.cost == pytest.approx(COST_SCALE * 2.1787, abs=1e-6)
    np.testing.assert_allclose(state.contacts.points, state.desired, atol=1e-6)
    center = state.model.load.center_of_mass
    np.testing.assert_allclose(state.contacts.normals, (center - state.contacts.points) / 0.0373, atol=1e-4)
    assert [found for found in grasp.problem.violations(state) if found.value > 1e-3] == []


def test_cost_is_squared_offsets_in_millimetres_and_weighted_V(grasp: Place) -> None:
    x = grasp.x.copy()
    x[-4:] += [0.003, 0.001, -0.002, 0.0]
    state = grasp.problem.state(x)
    phi = 1e6 * ((state.contacts.points - state.desired) ** 2).sum()
    weight = state.model.task.force_weight
    assert phi == pytest.approx(14.0, rel=1e-3)
    assert grasp.problem.evaluate(x).cost == pytest.approx(COST_SCALE * (phi + weight * state.forces.V))


def test_the_last_states_are_kept_whatever_becomes_of_their_points(grasp: Place) -> None:
    problem, x = GraspProblem(grasp.problem.model, grasp.problem.assignment), grasp.x.copy()
    state = problem.state(x)
    x[0] += 0.1
    np.testing.assert_array_equal(state.x, grasp.x)
    assert problem.state(x) is not state
    for k in range(KEPT - 2):
        problem.state(x + 0.01 * (k + 1))
    assert problem.state(grasp.x) is state
    for k in range(KEPT):
        problem.state(x - 0.01 * (k + 1))
    assert problem.state(grasp.x) is not state


def test_the_point_to_solve_from_is_evaluated_once(grasp: Place) -> None:
    """Its variables z = x / unit are none from which x comes back to the last digit."""
    problem = grasp.problem
    unit = problem.model.robot.step_units
    near = (np.clip(grasp.x + 1e-5 * k, problem.lower, problem.upper) for k in range(100))
    x = next(x for x in near if (x / unit * unit != x).any())
    recorder = Recorder(problem, 1e-6)
    program = program_from(recorder, x)
    assert program.cost(program.start)[0] == problem.evaluate(x).cost
    assert recorder.evaluations == 1
    program.cost(program.start + 1e-3)
    assert recorder.evaluations == 2


def test_violations_are_in_millimetres(grasp: Place) -> None:
    """The finger joint opened a little: gap and place as the contact points tell; a pad's name goes with it."""
    x = grasp.x.copy()
    x[7] -= 0.05
    problem, state = grasp.problem, grasp.problem.state(x)
    gaps = 1e3 * np.abs(np.linalg.norm(state.contacts.points - state.model.load.center_of_mass, axis=1) - 0.0373)
    [found] = [violation for violation in problem.violations(state) if violation.name == "contact gap"]
    assert gaps.max() > 1.0
    value = pytest.approx(gaps.max())
    assert found == Violation("contact gap", value, "mm", ["left", "right"][int(gaps.argmax())], size=value)
    assert problem.evaluate(x).violation >= 0.1 * gaps.max() * (1 - 1e-9)


# ---- checks of a task


def refused(robot: Robot, scene: Scene, key: str) -> InputError:
    with pytest.raises(InputError) as caught:
        check_placement(scene, "sphere")
        check_task(TaskModel(robot, scene, "sphere"))
    assert caught.value.file == scene.source
    assert caught.value.key == key
    assert str(scene.source) in str(caught.value)
    assert caught.value.remedy
    return caught.value


def refused_in_python(scene: Scene, task: str) -> TaskError:
    with pytest.raises(TaskError) as caught:
        check_placement(scene, task)
    return caught.value


def test_the_shipped_task_is_accepted(sphere_task: TaskModel) -> None:
    check_placement(sphere_task.scene, "sphere")
    check_task(sphere_task)


def test_object_outside_the_enclosure(gen3: Robot, glovebox: Scene) -> None:
    """5.3 mm above the floor's height of -0.237 m less radius: 1.6 mm through it, then 37.3 mm outside a side wall."""
    below = changed(glovebox, "objects", pose={"position": (0.801, 0.020, -0.2013)})
    assert "1.6 mm beyond wall z=-0.237" in refused(gen3, below, "objects.sphere.pose").problem
    beside = changed(glovebox, "objects", pose={"position": (0.801, 0.42, 0.0)})
    assert "37.3 mm beyond wall y=0.42" in refused(gen3, beside, "objects.sphere.pose").problem


def plate(overlap: float) -> Body:
    """A plate under the sphere, whose lowest point is 0.237 m below the origin, and this much of it in the plate, m."""
    return Body(shape=Box(size=(0.3, 0.3, 0.03)), pose=Pose(position=(0.801, 0.02, -0.237 + overlap - 0.015)))


def test_object_in_an_obstacle(glovebox: Scene) -> None:
    """10 mm deep in one plate and 4 mm in another: the deeper one is named."""
    scene = glovebox.with_obstacle("low", plate(0.004)).with_obstacle("plate", plate(0.010))
    error = refused_in_python(scene, "sphere")
    assert error.problem == "the object 'sphere' is 10.0 mm deep in the obstacle 'plate'"
    assert error.key == "objects.sphere.pose"
    assert error.remedy == "Move one of them; they may touch, and overlap by 1 mm"


def test_object_in_another_object(glovebox: Scene) -> None:
    """Centres 52.3 mm apart, radii of 37.3 and 20 mm."""
    other = Object(shape=Sphere(radius=0.02), pose=Pose(position=(0.801 + 0.0523, 0.02, -0.1997)))
    problem = refused_in_python(glovebox.with_object("ball", other), "sphere").problem
    assert problem == "the object 'sphere' is 5.0 mm deep in the object 'ball'"


def test_object_inside_a_turned_obstacle(glovebox: Scene) -> None:
    """A ball wholly in a box that is turned about z: out by its radius and half the box's least edge."""
    around = Body(shape=Box(size=(0.1, 0.4, 0.4)), pose=Pose(position=(0.801, 0.02, -0.1997), rpy=(0.0, 0.0, 0.7)))
    problem = refused_in_python(glovebox.with_obstacle("block", around), "sphere").problem
    assert problem == "the object 'sphere' is 87.3 mm deep in the obstacle 'block'"


@pytest.mark.parametrize("overlap", [-0.02, 0.0, 0.0009])
def test_an_object_may_touch_what_it_stands_on(glovebox: Scene, overlap: float) -> None:
    check_placement(glovebox.with_obstacle("plate", plate(overlap)), "sphere")


def test_a_little_more_than_a_touch_is_refused(glovebox: Scene) -> None:
    assert "1.1 mm deep" in refused_in_python(glovebox.with_obstacle("plate", plate(0.0011)), "sphere").problem


@pytest.mark.parametrize(("y", "side"), [(0.0380, "0.7 mm outside"), (0.0363, "1.0 mm inside")])
def test_desired_contact_off_the_surface(gen3: Robot, glovebox: Scene, y: float, side: str) -> None:
    scene = changed(glovebox, "tasks", desired_contacts=((0.0, 0.0373, 0.0), (0.0, -y, 0.0)))
    assert side in refused(gen3, scene, "tasks.sphere.desired_contacts[1]").problem


def test_one_desired_contact_for_each_pad(gen3: Robot, glovebox: Scene) -> None:
    r = 0.0373
    scene = changed(glovebox, "tasks", desired_contacts=((0.0, r, 0.0), (0.0, -r, 0.0), (r, 0.0, 0.0)))
    assert "3 desired contacts for a hand of 2 pads" in refused(gen3, scene, "tasks.sphere.desired_contacts").problem


def test_object_wider_than_the_jaw(gen3: Robot, glovebox: Scene) -> None:
    r = 0.045
    scene = changed(glovebox, "objects", shape={"type": "sphere", "radius": r}, pose={"position": (0.8, 0.0, 0.0)})
    scene = changed(scene, "tasks", desired_contacts=((0.0, r, 0.0), (0.0, -r, 0.0)))
    problem = refused(gen3, scene, "objects.sphere.shape").problem
    assert "85.0 mm" in problem
    assert "90.0 mm" in problem


# ---- the hand before a grasp


def test_the_2f85_opens_85_millimetres(gen3: Robot) -> None:
    jaw = jaw_range(gen3)
    assert jaw is not None
    assert 1e3 * jaw[1] == pytest.approx(85.0, abs=0.1)


def test_the_widest_jaw_of_the_toy_is_the_sum_of_its_strokes(toy: Robot) -> None:
    assert jaw_range(toy) == pytest.approx((0.002, 0.06 + 1.25 * 0.06 + 0.002))


@pytest.mark.parametrize("apart", [0.0, 0.03, 0.0746, 0.2])
def test_preshape_holds_the_pads_as_far_apart_as_the_points(gen3: Robot, apart: float) -> None:
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
    other_state = swapped.state(grasp.x)
    far = other_state.contacts.points - other_state.desired
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
        J, values, x = rng.normal(size=(6, 5)), rng.normal(size=6), 9.0 * rng.integers(-1, 2, 5)
        unit = rng.uniform(0.5, 2.0, 5)
        step = (damped_step(values, J, x, unit, np.full(5, -9.0), np.full(5, 9.0), 0.1) - x) / unit
        assert (step * x <= 0.0).all()
        free = step != 0.0
        held += int((~free).sum())
        J *= unit
        normal = J[:, free].T @ J[:, free] + 0.1 * np.eye(int(free.sum()))
        np.testing.assert_allclose(normal @ step[free], -J[:, free].T @ values, atol=1e-12)
    assert held > 20


def test_an_object_that_moves_has_the_same_pairs(sphere_task: TaskModel) -> None:
    """Proposals move the object for every pair that they try: how pairs belong to links is not found out again."""
    elsewhere = sphere_task.scene.with_object_pose("sphere", Pose(position=(0.7, 0.0, 0.1)))
    collisions = sphere_task.moved("sphere", elsewhere).collisions
    assert collisions.link_pairs is sphere_task.collisions.link_pairs
    assert collisions.pad_pairs is sphere_task.collisions.pad_pairs
