"""Contact on a mesh: what is found is that of the shape that it stands for, and every link keeps its distance."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import meshes
import numpy as np
import pytest
from places import Place, changed, project, random_starts

from pinograsp.collision.object_points import object_points
from pinograsp.collision.solids import link_bodies
from pinograsp.collision.world import Body
from pinograsp.descriptions import Scene
from pinograsp.errors import TaskError
from pinograsp.geometry.exact_distance import ExactDistance
from pinograsp.geometry.field_kernels import ABOVE
from pinograsp.geometry.hulls import Hull
from pinograsp.geometry.patches import half_sides
from pinograsp.geometry.tessellation import Tessellation, refined
from pinograsp.kinematics.robot import Robot
from pinograsp.problem import GraspProblem, TaskModel, check_placement
from pinograsp.problem.constraints.object_clearance import object_clearance
from pinograsp.problem.constraints.pad_depth import pad_depth
from pinograsp.problem.constraints.pad_tangency import tilt_of
from pinograsp.problem.constraints.pad_tilt import PadTilt
from pinograsp.problem.costs.pad_tilt import LEVER
from pinograsp.problem.costs.pad_tilt import pad_tilt as tilt_cost
from pinograsp.solve.local import LocalSolver, Solution
from pinograsp.solve.options import SolverOptions
from pinograsp.solve.projection import nearest_assignment

CYLINDER = {"type": "cylinder", "radius": 0.033, "height": 0.07}
BOX = {"type": "box", "size": (0.05, 0.06, 0.07)}
SHAPES: dict[str, tuple[Any, Any, float]] = {
    "sphere": ({"type": "sphere", "radius": 0.0373}, meshes.ball(0.0373, 5), 0.0373),
    "cylinder": (CYLINDER, meshes.cylinder(0.033, -0.035, 0.035, sections=256), 0.033),
    "box": (BOX, meshes.box([-0.025, -0.03, -0.035], [0.025, 0.03, 0.035]), 0.03),
}
"""Shapes, each with a mesh of it, and where its desired contacts are along y, m."""


def mesh_shape(mesh: Any, folder: Path) -> dict[str, Any]:
    return {"type": "mesh", "file": str(meshes.written(mesh, folder / "body.ply")), "unit": "m"}


def scene_of(glovebox: Scene, shape: dict[str, Any], across: float) -> Scene:
    points = ((0.0, across, 0.0), (0.0, -across, 0.0))
    return changed(changed(glovebox, "objects", shape=shape), "tasks", desired_contacts=points)


def cost_of(solution: Solution) -> float:
    """Return U (10)."""
    state = solution.state
    assert state is not None
    phi = 1e6 * float(((state.contacts.points - state.desired) ** 2).sum())
    return phi + state.model.task.force_weight * state.forces.V


@pytest.mark.parametrize("name", SHAPES)
def test_a_fine_mesh_leads_to_the_grasps_of_its_shape(name: str, gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    shape, mesh, across = SHAPES[name]
    model = TaskModel(gen3, scene_of(glovebox, shape, across), "sphere")
    meshed = TaskModel(gen3, scene_of(glovebox, mesh_shape(mesh, tmp_path), across), "sphere")
    check_placement(meshed.scene, "sphere")
    assert meshed.surface.least_width == pytest.approx(model.surface.least_width, rel=1e-3)
    starts = random_starts(model, 3, 0)
    best = min(cost_of(LocalSolver(model, SolverOptions()).solve(i, start)) for i, start in enumerate(starts))
    solved = [LocalSolver(meshed, SolverOptions()).solve(i, start) for i, start in enumerate(starts)]
    assert all(solution.feasible for solution in solved)
    assert min(map(cost_of, solved)) == pytest.approx(best, rel=0.01)
    R, origin = meshed.T_world_object[:3, :3], meshed.T_world_object[:3, 3]
    for solution in solved:
        assert solution.state is not None
        gaps = meshed.surface.exact_distances((solution.state.contacts.points - origin) @ R)
        assert np.abs(gaps).max() < 2e-6
        tilts = np.linalg.norm(tilt_of(solution.state).values.reshape(-1, 3), axis=1)
        assert np.degrees(tilts).max() < 5.0


NEAR = ("robotiq_85_base_link", "robotiq_85_left_inner_knuckle_link", "robotiq_85_right_finger_link")
"""Links of which none of the solids is behind a pad."""


@pytest.fixture(scope="module")
def hammer(gen3: Robot, glovebox: Scene, tmp_path_factory: pytest.TempPathFactory) -> TaskModel:
    """A hammer that lies, to be held at its handle."""
    shape = mesh_shape(meshes.hammer(), tmp_path_factory.mktemp("hammer"))
    scene = changed(glovebox, "objects", shape=shape, pose={"position": (0.6, 0.05, -0.1), "rpy": (1.5, 0.1, 0.4)})
    points = ((0.0, 0.012, -0.04), (0.0, -0.012, -0.04))
    return TaskModel(gen3, changed(scene, "tasks", desired_contacts=points), "sphere")


@pytest.fixture(scope="module")
def places(hammer: TaskModel) -> list[Place]:
    """Projected starts: some of them have links in the hammer."""
    found = []
    for posture in random_starts(hammer, 4, 1):
        problem = GraspProblem(hammer, (0, 1))
        x = np.concatenate([posture, 0.5 * (problem.lower + problem.upper)[len(posture) :]])
        problem = GraspProblem(hammer, nearest_assignment(hammer, problem.state(x)))
        found.append(Place(problem, project(problem, x, "contacts")))
    return found


def least_distance(place: Place, body: Body) -> float:
    """Return the exact distance of a link to the object, m: of points of its solids two millimetres apart."""
    state = place.state
    model, configuration = state.model, state.configuration
    tessellation = model.surface.tessellation()
    exact = ExactDistance(tessellation.vertices, tessellation.triangles)
    T = np.linalg.inv(model.T_world_object)
    distances = [math.inf]
    for solid in body.solids:
        corners = Hull(np.array(solid.shape.points())).triangles.reshape(-1, 3)
        points = refined(Tessellation(corners, np.arange(len(corners)).reshape(-1, 3)), 0.002).vertices
        points = points @ solid.placement[:3, :3].T + solid.placement[:3, 3]
        points = points @ configuration.rotations[body.joint].T + configuration.translations[body.joint]
        points = points @ T[:3, :3].T + T[:3, 3]
        low, high = tessellation.vertices.min(axis=0), tessellation.vertices.max(axis=0)
        about = ((points > low) & (points < high)).all(axis=1)  # those that may be inside: the sign takes long
        distances.append(float(exact.unsigned(points).min()))
        if about.any():
            distances.append(float(exact.signed(points[about]).min()))
    return min(distances)


def test_links_are_as_far_from_the_object_as_their_points(hammer: TaskModel, places: list[Place]) -> None:
    """A row is no more than a few times what its link has above the margin, and negative where that is."""
    clearance = object_clearance(hammer)
    assert clearance is not None
    bodies = [body for body in link_bodies(hammer.robot) if body.name in NEAR]
    near = 0
    for place in places:
        values = dict(zip(clearance.rows, clearance.inside(place.state).values.tolist(), strict=True))
        for body in bodies:
            above = least_distance(place, body) - hammer.task.margin.object
            row = values[f"object clearance of {body.name}"]
            assert row < max(above, 0.0) / (1.0 - ABOVE) + 3e-4
            if -0.02 < above < 0.01:
                near += 1
                assert row > above - 2.5e-3
    assert near > 3


def test_what_is_measured_is_each_link_once(hammer: TaskModel) -> None:
    """Pads and what is behind them may be pressed in; all else keeps the margin; nothing is in both."""
    points = object_points(hammer.robot, 0.001)
    links, pads = points.sets[: points.links], points.sets[points.links :]
    kept, depths = np.split(points.least, [points.links])
    assert (kept >= 0.001).all()
    of_hand = np.array([found.link.startswith("robotiq") for found in links])
    assert kept[of_hand].max() < 0.002
    assert kept[~of_hand].max() < 0.006
    rubber = np.array([found.yields for found in pads])
    assert set(-depths[rubber]) == {pad.rubber_depth for pad in hammer.robot.description.pads}
    assert (depths[~rubber] > 0.0).all()
    assert {found.link for found in pads} == {pad.link for pad in hammer.robot.description.pads}
    assert sum(found.apart == 0.0 for found in pads) == 8  # quarters of two faces
    assert not any(found.pads for found in links)
    assert all(found.pads for found in pads)


def test_nothing_goes_through_a_pad_into_its_backing(hammer: TaskModel) -> None:
    """Rubber of 1 mm is 2 mm thick. Every place where it ends is so near to a point there that this says so."""
    points = object_points(hammer.robot, 0.001)
    lids = [
        number
        for number, found in enumerate(points.sets)
        if found.pads and found.apart == pytest.approx(0.001 / math.sqrt(2.0))
    ]
    assert [points.sets[number].pads for number in lids] == [(0,), (1,)]
    for number, pad in zip(lids, hammer.robot.pads, strict=True):
        assert 0.0 < points.least[number] < pad.description.rubber_depth  # else it would be the deeper of both
        local = (points.sets[number].points - pad.translation) @ pad.rotation
        np.testing.assert_allclose(local[:, 2], -0.002, atol=1e-9)
        # Away from the rim, where the link is rounded.
        places = np.random.default_rng(0).uniform(*(0.9 * np.array(pad.patch.parameters).T), (1000, 2))
        away = np.linalg.norm(places[:, None] - local[:, :2], axis=2).min(axis=1)
        assert away.max() < math.sqrt(points.least[number] ** 2 - 0.0002**2) + 1e-12
        # The link goes on behind the pad, 27 mm from its middle, where the rim of a can got in unseen.
        assert local[:, 0].min() < -0.025 < pad.patch.parameters[0][0]


def test_pads_are_as_deep_as_their_deepest_point(hammer: TaskModel, places: list[Place]) -> None:
    depth = pad_depth(hammer)
    assert depth is not None
    tessellation = hammer.surface.tessellation()
    exact = ExactDistance(tessellation.vertices, tessellation.triangles)
    T = np.linalg.inv(hammer.T_world_object)
    for place in places:
        state, values = place.state, depth.inside(place.state).values
        for number, pad in enumerate(hammer.robot.pads):
            (u, v), joint = np.array(pad.patch.parameters), pad.joint
            local = np.array([[a, b, 0.0] for a in np.linspace(*u, 30) for b in np.linspace(*v, 20)])
            points = local @ pad.rotation.T + pad.translation
            points = points @ state.configuration.rotations[joint].T + state.configuration.translations[joint]
            deepest = float(exact.signed(points @ T[:3, :3].T + T[:3, 3]).min())
            row = float(values[4 * number : 4 * number + 4].min())
            assert row == pytest.approx(deepest + pad.description.rubber_depth, abs=3e-4)


def test_the_cone_of_tilts(hammer: TaskModel, places: list[Place]) -> None:
    """Rows are zero where the normal is at the border that rubber and sides of a pad say, seen from the pad."""
    tilt = PadTilt(hammer)
    for place in places:
        state, row = place.state, 0
        values = tilt.inside(state).values
        for i, pad in enumerate(hammer.robot.pads):
            R = state.configuration.rotations[pad.joint] @ pad.rotation
            x, y, z = state.footprint[0][i] @ R
            limits = pad.description.rubber_depth / half_sides(pad.patch)
            expected = [-limits[0] * z - x, -limits[0] * z + x, -limits[1] * z - y, -limits[1] * z + y]
            np.testing.assert_allclose(values[row + 1 : row + 5], expected, atol=1e-12)
            steepest = 2.0 * math.sin(math.radians(2.25))  # half of 4.5 degrees, in any direction
            assert values[row] == pytest.approx(0.5 * (steepest - (2.0 + 2.0 * z) / steepest), abs=1e-9)
            row += 5
    [half_x, half_y] = half_sides(hammer.robot.pads[0].patch)
    angles = sorted(math.degrees(math.atan(0.001 / half)) for half in (half_x, half_y))
    assert angles == pytest.approx([3.2, 5.7], abs=0.1)


def test_tilt_costs_what_the_rim_of_a_pad_is_off(hammer: TaskModel, places: list[Place]) -> None:
    cost = tilt_cost(hammer)
    assert cost is not None
    state = places[0].state
    angles = 2.0 * np.arcsin(0.5 * np.linalg.norm(tilt_of(state).values.reshape(-1, 3), axis=1))
    assert cost.value(state)[0] == pytest.approx(float(((LEVER * 2.0 * np.sin(0.5 * angles)) ** 2).sum()))


def test_forces_are_about_what_pads_feel(hammer: TaskModel, places: list[Place]) -> None:
    state = places[0].state
    np.testing.assert_array_equal(state.grasp.normals, -state.footprint[0])
    assert not np.allclose(state.footprint[0], state.surface[1], atol=1e-6)


def test_a_smooth_shape_is_touched_as_before(sphere_task: TaskModel) -> None:
    """No cone, no depth, no point of a link: Coal measures it."""
    for make in (object_clearance, pad_depth, tilt_cost):
        assert make(sphere_task) is None
    problem = GraspProblem(sphere_task, (0, 1))
    state = problem.state(0.5 * (problem.lower + problem.upper))
    assert state.footprint[0] is state.surface[1]
    assert state.grasp.normals is state.contacts.normals


def test_a_mesh_moves_with_its_pose(hammer: TaskModel) -> None:
    pose = {"position": (0.62, 0.0, -0.08), "rpy": (1.2, 0.1, 0.4)}
    scene = changed(hammer.scene, "objects", pose=pose)
    moved, made = hammer.moved("sphere", scene), TaskModel(hammer.robot.unmounted, scene, "sphere")
    problems = [GraspProblem(model, (0, 1)) for model in (moved, made)]
    x = 0.5 * (problems[0].lower + problems[0].upper)
    first, second = (problem.evaluate(x) for problem in problems)
    np.testing.assert_allclose(first.inequalities.values, second.inequalities.values, atol=1e-12)
    np.testing.assert_allclose(first.equalities.values, second.equalities.values, atol=1e-12)


# ---- checks of the scene


def test_a_desired_contact_must_be_on_the_mesh(hammer: TaskModel) -> None:
    scene = changed(hammer.scene, "tasks", desired_contacts=((0.0, 0.0125, -0.04), (0.0, -0.012, -0.04)))
    with pytest.raises(TaskError, match=r"0\.5 mm outside the surface"):
        check_placement(scene, "sphere")
    check_placement(hammer.scene, "sphere")


@pytest.mark.parametrize(("lowered", "deep"), [(0.0005, False), (0.003, True)])
def test_a_mesh_stands_on_what_it_touches(glovebox: Scene, tmp_path: Path, lowered: float, deep: bool) -> None:
    """A mug on a shelf: its cover reaches further down than it does."""
    content = glovebox.model_dump()
    x, y, z = content["objects"]["sphere"]["pose"]["position"]
    content["objects"]["sphere"] |= {"shape": mesh_shape(meshes.mug(), tmp_path)}
    content["tasks"]["sphere"]["desired_contacts"] = ((0.0, 0.04, 0.05), (0.0, -0.04, 0.05))
    shelf = {"shape": {"type": "box", "size": (0.2, 0.2, 0.02)}, "pose": {"position": (x, y, z - 0.01 + lowered)}}
    content["obstacles"] = {"shelf": shelf}
    scene = Scene.model_validate(content)
    if deep:
        with pytest.raises(TaskError, match=r"3\.0 mm deep in the obstacle 'shelf'"):
            check_placement(scene, "sphere")
    else:
        check_placement(scene, "sphere")
