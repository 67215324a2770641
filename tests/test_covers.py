"""Convex pieces that stand for collision meshes: containment, excess, cache, and the distances that they give."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import coal
import numpy as np
import pinocchio as pin
import pytest
import trimesh
from conftest import (
    TOY_URDF,
    Array,
    PlacedSolid,
    RobotFactory,
    SceneFactory,
    collision_model,
    link_solids,
    placed,
    solids_of,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, cKDTree

from benchmark_covers import excess
from pinograsp import cache_folder
from pinograsp.collision.batch_clearance import BatchClearance
from pinograsp.collision.distances import CollisionModel
from pinograsp.collision.scene_world import enclosure_world
from pinograsp.collision.solids import link_bodies
from pinograsp.descriptions import Scene
from pinograsp.descriptions.task import Margins
from pinograsp.errors import CacheWarning, InputError
from pinograsp.geometry import cover_cache, covers
from pinograsp.geometry.cover_cache import mesh_cover
from pinograsp.geometry.covers import clip, cover
from pinograsp.geometry.hulls import FlatError
from pinograsp.geometry.mesh_file import read_triangles
from pinograsp.kinematics.collision_elements import collision_elements
from pinograsp.kinematics.forward import forward
from pinograsp.kinematics.robot import Robot
from pinograsp.problem import TaskModel
from pinograsp.verification.check import Verifier

TOLERANCE = 0.004


def beyond(points: Array, pieces: Sequence[Array]) -> float:
    """Return how far the worst of the points is beyond the facets of the piece that it is in, or nearest to."""
    left, worst = points, np.zeros(0)
    for vertices in pieces:
        equations = ConvexHull(vertices).equations
        heights = (left @ equations[:, :3].T + equations[:, 3]).max(axis=1)
        worst = heights if not len(worst) else np.minimum(worst, heights)
        left, worst = left[worst > 1e-10], worst[worst > 1e-10]
        if not len(left):
            return 0.0
    return float(worst.max())


def on_triangles(triangles: Array, count: int) -> Array:
    """Return the corners and random points of triangles, as many of every triangle as its area says."""
    rng = np.random.default_rng(5)
    areas = np.linalg.norm(np.cross(*(triangles[:, 1:] - triangles[:, :1]).transpose(1, 0, 2)), axis=1)
    chosen = rng.choice(len(triangles), count, p=areas / areas.sum())
    return np.concatenate(
        [
            np.unique(triangles.reshape(-1, 3), axis=0),
            (rng.dirichlet([1, 1, 1], count)[:, None] @ triangles[chosen])[:, 0],
        ]
    )


# ---- meshes of the Gen3


Meshes = dict[str, tuple[Any, Array]]


@pytest.fixture(scope="module")
def meshes(gen3: Robot, glovebox: Scene) -> Meshes:
    """Coal's tree of every link's meshes and their triangles, link frame, as the verification has them."""
    found = Verifier(gen3.description, glovebox, "sphere")._robot.meshes
    return {link: (mesh.solid, mesh.triangles) for link, mesh in found.items()}


@pytest.fixture(scope="module")
def pieces(gen3: Robot) -> dict[str, list[Array]]:
    """Vertices of the pieces as Coal has them, link frame, by link."""
    found = by_link(link_solids(gen3))
    for link, all_points in found.items():
        place = gen3.model.frames[gen3.model.getFrameId(link, pin.BODY)].placement
        found[link] = [(points - place.translation) @ place.rotation for points in all_points]
    return found


def by_link(solids: Sequence[PlacedSolid]) -> dict[str, list[Array]]:
    """Return the vertices of solids in their joint's frame, by link."""
    found: dict[str, list[Array]] = {}
    for solid in solids:
        points = np.array(solid.shape.points()) @ solid.placement[:3, :3].T + solid.placement[:3, 3]
        found.setdefault(solid.name, []).append(points)
    return found


def test_pieces_of_the_gen3_contain_its_meshes(meshes: Meshes, pieces: dict[str, list[Array]]) -> None:
    """Vertices and points of all triangles, read by other code than that which made the pieces."""
    assert meshes.keys() == pieces.keys()
    for link, (_, triangles) in meshes.items():
        assert beyond(on_triangles(triangles, 2000), pieces[link]) <= 1e-9
    assert beyond(meshes["half_arm_1_link"][1].reshape(-1, 3), pieces["half_arm_1_link"][1:]) > 1e-3


def test_meshes_are_where_pinocchio_reads_them(gen3: Robot) -> None:
    """Units, axes and scenes of the files. (Only vertices: of several bodies in one file Coal mixes up the faces.)"""
    geometry = pin.buildGeomFromUrdfString(gen3.model, gen3.urdf.xml, pin.GeometryType.COLLISION)
    elements = collision_elements(gen3)
    assert len(elements) == len(geometry.geometryObjects) == 17
    for element, item in zip(elements, geometry.geometryObjects, strict=True):
        assert element.mesh == Path(item.meshPath)
        assert element.joint == item.parentJoint
        np.testing.assert_allclose(element.placement, item.placement.homogeneous, atol=1e-12)
        ours, theirs = (
            cKDTree(v) for v in (read_triangles(element.mesh, element.size).reshape(-1, 3), item.geometry.vertices())
        )
        assert max(ours.query(theirs.data)[0].max(), theirs.query(ours.data)[0].max()) < 1e-9


def test_pieces_of_the_gen3_stand_off_10_mm_at_most(meshes: Meshes, pieces: dict[str, list[Array]]) -> None:
    """At the 95th percentile, where single hulls of the arm's links stand off up to 30 mm; the fingers need no cut."""
    of_hulls, of_pieces = [], []
    for link, (_, triangles) in meshes.items():
        if link.startswith("robotiq"):
            assert len(pieces[link]) == 1
            continue
        assert len(pieces[link]) <= 8
        of_pieces.append(np.percentile(excess(pieces[link], triangles, 1500), 95))
        of_hulls.append(np.percentile(excess([np.concatenate(pieces[link])], triangles, 500), 95))
    assert max(of_pieces) <= 0.010
    assert max(of_hulls) > 0.025


def test_distances_lie_between_those_of_single_hulls_and_of_the_meshes(
    gen3: Robot, gen3_hulls: Robot, glovebox: Scene, meshes: Meshes
) -> None:
    """Link by link, with the arm folded and the object close to each of its links in turn."""
    data, rng = gen3.model.createData(), np.random.default_rng(3)
    folded = 0.9 * gen3.upper
    compared, gains = 0, []
    for link in ["shoulder_link", "half_arm_1_link", "half_arm_2_link", "forearm_link", "spherical_wrist_1_link"]:
        at = forward(gen3, data, folded + rng.uniform(-0.3, 0.0, gen3.posture_size))
        frame = gen3.model.frames[gen3.model.getFrameId(link, pin.BODY)]
        R, p = at.rotations[frame.parentJoint], at.translations[frame.parentJoint]
        center = frame.placement.act(meshes[link][1].reshape(-1, 3).mean(axis=0))
        away = rng.normal(size=3)
        scene = with_object_at(glovebox, R @ center + p + 0.1 * away / np.linalg.norm(away))
        models = [collision_model(robot, scene, "sphere") for robot in (gen3_hulls, gen3)]
        of_hulls, of_pieces = (least_by_links(model, at) for model in models)
        assert of_hulls.keys() == of_pieces.keys()
        for (one, other), distance in of_pieces.items():
            exact = mesh_distance(models[1], at, meshes, one, other)
            gains.append(distance - of_hulls[one, other])
            assert gains[-1] >= -2e-6
            if exact > 0.0:
                assert distance <= exact + 2e-6
                compared += of_hulls[one, other] < 0.05
    assert compared >= 5
    assert max(gains) > 0.01


def with_object_at(scene: Scene, position: Array) -> Scene:
    """Return the scene with the object of the task `sphere` elsewhere."""
    content = scene.model_dump()
    content["objects"][scene.task("sphere").object]["pose"]["position"] = tuple(position.tolist())
    return Scene.model_validate(content)


def least_by_links(model: CollisionModel, at: Any) -> dict[tuple[str, str], float]:
    """Return the least distance of every two links, and of links and the object."""
    indices = np.array([i for i, pair in enumerate(model.pairs) if pair.kind != "enclosure clearance"])
    values, _, _ = model.measure(indices, at)
    least: dict[tuple[str, str], float] = {}
    for index, value in zip(indices, values.tolist(), strict=True):
        pair = model.pairs[index]
        least[pair.link, pair.other] = min(least.get((pair.link, pair.other), np.inf), value)
    return least


def mesh_distance(collisions: CollisionModel, at: Any, meshes: Meshes, link: str, other: str) -> float:
    """Return the distance of a link's mesh to another one or to the object; not positive if they intersect."""
    model = collisions._robot.model

    def placed(name: str) -> tuple[Any, Any]:
        if name not in meshes:
            target = solids_of(collisions)[-1]
            return target.shape, coal.Transform3s(target.placement[:3, :3], target.placement[:3, 3])
        frame = model.frames[model.getFrameId(name, pin.BODY)]
        R, p = at.rotations[frame.parentJoint], at.translations[frame.parentJoint]
        local = frame.placement
        return meshes[name][0], coal.Transform3s(R @ local.rotation, R @ local.translation + p)

    return float(coal.distance(*placed(link), *placed(other), coal.DistanceRequest(), coal.DistanceResult()))


def test_walls_see_the_nearest_piece(sphere_task: TaskModel) -> None:
    """The one hull of a link that stands before a wall has the distance of the pieces' nearest vertex."""
    model, robot = sphere_task.collisions, sphere_task.robot
    at = forward(robot, robot.model.createData(), 0.3 * robot.lower + 0.7 * robot.upper)
    indices = np.array([i for i, pair in enumerate(model.pairs) if pair.other.startswith("wall")])
    values, _, _ = model.measure(indices, at)
    solids = link_solids(robot)
    joints = {solid.name: solid.joint for solid in solids}
    vertices = {link: np.concatenate(points) for link, points in by_link(solids).items()}
    assert len(indices) == 6 * 16
    for index, value in zip(indices, values, strict=True):
        pair, wall = model.pairs[index], model.shapes[model.pairs[index].second]
        joint = joints[pair.link]
        points = vertices[pair.link] @ at.rotations[joint].T + at.translations[joint]
        assert (points @ np.array(wall.n)).min() - wall.d == pytest.approx(value, abs=1e-9)


def test_link_hulls_are_hulls_of_the_pieces_of_a_link(gen3: Robot, gen3_hulls: Robot, toy: Robot) -> None:
    hulls = by_link(link_solids(gen3_hulls))
    for body in link_bodies(gen3):
        [hull] = body.hulls
        assert hull.parts == tuple(range(len(body.solids)))
        [[corners]] = by_link([placed(body, hull.solid)]).values()
        assert ConvexHull(corners).volume == pytest.approx(ConvexHull(hulls[body.name][0]).volume, rel=1e-9)
    assert [hull.parts for body in link_bodies(toy) for hull in body.hulls] == [(0,)] * 4


def test_a_margin_between_links_counts_also_where_a_wall_is_nearer(toy: Robot, make_toy_scene: SceneFactory) -> None:
    """The arm laid down: 40 mm from a wall, the finger 0.16 m from the base with 0.13 m between bounding spheres."""
    scene = make_toy_scene(enclosure={"min": [-0.4, -0.06, -0.2], "max": [0.4, 0.06, 0.4]})
    for margin, kept in ((0.10, [0]), (0.18, [])):
        batch = BatchClearance(toy, enclosure_world(toy, scene, Margins(enclosure=0.0, robot=margin)), np.zeros(1))
        assert batch.measure(np.array([[1.4]]))[0].tolist() == kept


def test_what_is_behind_the_pad_is_not_kept_off_the_object(
    make_toy: RobotFactory, make_toy_scene: SceneFactory
) -> None:
    """A finger with a hook at its end: its pad is the plane x = 0, before which only the hook stands."""
    finger = '<origin xyz="0.005 0 0.02"/><geometry><box size="0.01 0.02 0.04"/></geometry>'
    hook = '<origin xyz="-0.005 0 0.045"/><geometry><box size="0.03 0.02 0.01"/></geometry>'
    robot = make_toy(TOY_URDF.replace(finger, f"{finger}</collision><collision>{hook}"))
    scene = make_toy_scene()
    model = collision_model(robot, scene, "ball")
    left = [i for i, solid in enumerate(link_solids(robot)) if solid.name == "left"]
    assert len(left) == 2
    assert [pair.first for pair in model.pairs if pair.kind == "object clearance" and pair.link == "left"] == left[1:]


# ---- other shapes


def prism(outline: Sequence[tuple[float, float]], faces: Sequence[tuple[int, int, int]], height: float) -> Array:
    """Return the triangles of a prism over a polygon that is given with a triangulation, both counterclockwise."""
    n = len(outline)
    low, high = (np.column_stack([outline, np.full(n, z)]) for z in (0.0, height))
    sides = [np.array([low[k], low[(k + 1) % n], high[(k + 1) % n], high[k]]) for k in range(n)]
    walls = [side[[i, j, k]] for side in sides for i, j, k in ((0, 1, 2), (0, 2, 3))]
    return np.array([*walls, *(high[list(face)] for face in faces), *(low[list(face[::-1])] for face in faces)])


def bent(shape: str, long: float, wide: float, thick: float) -> tuple[Array, Array]:
    """Return the triangles of an L, a U or a torus and points inside it, shape (n, 3)."""
    rng = np.random.default_rng(2)
    w, h = thick, long
    if shape == "torus":
        mesh = trimesh.creation.torus(long, thick, major_sections=24, minor_sections=12)
        turn, across = rng.uniform(0, 2 * np.pi, (2, 300))
        rho, r = rng.uniform(0, 0.9 * thick, 300), long * np.cos(np.pi / 24)
        radius = r + rho * np.cos(across) * 0.9
        inside = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), 0.9 * rho * np.sin(across)])
        return np.array(mesh.triangles), inside
    if shape == "L":
        outline = [(0, 0), (long, 0), (long, w), (w, w), (w, h), (0, h)]
        faces, boxes = [(0, 1, 2), (0, 2, 3), (0, 3, 5), (3, 4, 5)], [((0, 0), (long, w)), ((0, 0), (w, h))]
    else:
        x = long - w
        outline = [(0, 0), (long, 0), (long, h), (x, h), (x, w), (w, w), (w, h), (0, h)]
        faces = [(0, 1, 4), (0, 4, 5), (1, 2, 4), (2, 3, 4), (0, 5, 7), (5, 6, 7)]
        boxes = [((0, 0), (long, w)), ((0, 0), (w, h)), ((x, 0), (long, h))]
    inside = np.concatenate([rng.uniform([*low, 0], [*high, wide], (100, 3)) for low, high in boxes])
    return prism(outline, faces, wide), inside


@settings(max_examples=6)
@given(
    shape=st.sampled_from(["L", "U", "torus"]),
    long=st.floats(0.1, 0.3),
    wide=st.floats(0.01, 0.2),
    thick=st.floats(0.01, 0.03),
    turn=st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3),
    pieces=st.integers(2, 4),
)
def test_pieces_contain_a_bent_body_and_what_is_inside(
    shape: str, long: float, wide: float, thick: float, turn: list[float], pieces: int
) -> None:
    triangles, inside = bent(shape, long, wide, thick)
    R = pin.rpy.rpyToMatrix(*turn)
    triangles, inside = triangles @ R.T, inside @ R.T
    found = cover(triangles, pieces, 1e-3)
    assert 1 < len(found) <= pieces
    assert beyond(on_triangles(triangles, 500), found) <= 1e-9
    assert beyond(inside, found) <= 1e-9


@pytest.mark.parametrize(("shape", "pieces", "share"), [("L", 2, 0.05), ("U", 3, 0.2), ("U", 5, 0.05)])
def test_pieces_of_a_bent_body_follow_it(shape: str, pieces: int, share: float) -> None:
    """What they leave of the mean square of the hull's excess."""
    triangles, _ = bent(shape, 0.2, 0.05, 0.03)
    of_pieces, of_hull = (excess(cover(triangles, count, 1e-4), triangles, 1000) for count in (pieces, 1))
    assert np.square(of_pieces).mean() < share * np.square(of_hull).mean()


def test_an_elbow_is_cut_along_its_diagonal_plane() -> None:
    """Two legs, two pieces, and only the wedge under the inner edge is left: the hull would add half the square."""
    triangles, _ = bent("L", 0.2, 0.05, 0.03)
    found = cover(triangles, 2, 1e-3)
    assert len(found) == 2
    solid = 0.05 * (0.2 * 0.03 + 0.17 * 0.03)
    assert sum(ConvexHull(vertices).volume for vertices in found) < 1.15 * solid
    assert ConvexHull(triangles.reshape(-1, 3)).volume > 2.0 * solid


def test_octants_of_a_ball_contain_its_middle() -> None:
    """Their share of the surface alone spans only what lies beyond the plane of its corners."""
    ball = np.array(trimesh.creation.icosphere(3).triangles)
    planes = tuple(covers._Plane(-axis, 0.0) for axis in np.eye(3))
    octant = ball
    for plane in planes:
        octant, _ = clip(octant, *plane)
    points = np.random.default_rng(0).dirichlet([1, 1, 1], 100) * 0.5
    assert beyond(points, [octant.reshape(-1, 3)]) > 0.05
    whole = covers._Part(ball, (), covers.Hull(ball.reshape(-1, 3)))
    assert beyond(points, [covers._part(octant, planes, whole).hull.vertices]) <= 1e-9
    # Outside the ball, a corner of a cell is no part of the solid.
    far = tuple(covers._Plane(-axis, -0.7) for axis in np.eye(3))
    assert len(covers._corners(far)) == 1
    assert len(covers._part(octant, far, whole).hull.vertices) == len(ConvexHull(octant.reshape(-1, 3)).vertices)


def test_clipping_loses_and_adds_no_area() -> None:
    triangles, _ = bent("torus", 0.2, 0.0, 0.04)
    normal = np.array([0.6, 0.64, 0.48])
    parts = clip(triangles, normal, 0.03)
    sizes = [trimesh.triangles.area(part).sum() for part in parts]
    assert sum(sizes) == pytest.approx(trimesh.triangles.area(triangles).sum(), rel=1e-12)
    assert min(sizes) > 0.01
    assert (parts[0] @ normal).max() <= 0.03 + 1e-15
    assert (parts[1] @ normal).min() >= 0.03 - 1e-15
    # Triangles in the plane go to one side only.
    box = np.array(trimesh.creation.box().triangles)
    assert [len(part) for part in clip(box, np.array([0.0, 0.0, 1.0]), 0.5)] == [12, 0]


def test_excess_is_measured_on_the_outside_only() -> None:
    """Of a cube within a larger one, and of one whose halves are covered each by itself."""
    box = np.array(trimesh.creation.box((0.2, 0.2, 0.2)).triangles)
    corners = np.unique(box.reshape(-1, 3), axis=0)
    around = excess([1.5 * corners], box)
    assert around.min() == pytest.approx(0.05, abs=1e-5)
    assert 0.05 * np.sqrt(2) < around.max() <= 0.05 * np.sqrt(3) + 1e-5
    halves = [part.reshape(-1, 3) for part in clip(box, np.array([1.0, 0.0, 0.0]), 0.0)]
    assert excess(halves, box).max() <= 1e-5


def test_a_convex_mesh_is_not_cut_and_a_sheet_is_one_thin_piece() -> None:
    ball = np.array(trimesh.creation.icosphere(2).triangles)
    assert len(cover(ball, 8, TOLERANCE)) == 1
    triangles, _ = bent("L", 0.2, 0.05, 0.03)
    [hull] = cover(triangles, 1, 1e-3)
    assert ConvexHull(hull).volume == pytest.approx(ConvexHull(triangles.reshape(-1, 3)).volume)
    assert len(cover(triangles, 8, 0.2)) == 1
    flat = triangles.copy()
    flat[:, :, 2] = 0.0
    [sheet] = cover(flat, 8, TOLERANCE)
    assert 0.0 < np.ptp(sheet[:, 2]) < 1e-6
    planes = ConvexHull(sheet).equations
    assert (flat.reshape(-1, 3) @ planes[:, :3].T + planes[:, 3]).max() <= 1e-9
    flat[:, :, 1] = 0.0
    with pytest.raises(FlatError):
        cover(flat, 8, TOLERANCE)


# ---- robot files


def bracket(folder: Path, name: str = "bracket.stl") -> Path:
    """Write an L of 200 mm as a mesh in millimetres."""
    triangles, _ = bent("L", 200.0, 50.0, 30.0)
    mesh = trimesh.Trimesh(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))
    mesh.export(folder / name)
    return folder / name


def with_bracket(make_toy: RobotFactory, mesh: Path, **changes: Any) -> Robot:
    """Return the toy with the mesh for its arm."""
    box = '<geometry><box size="0.04 0.04 0.16"/></geometry>'
    geometry = f'<geometry><mesh filename="{mesh.name}" scale="0.001 0.001 0.001"/></geometry>'
    assert box in TOY_URDF
    return make_toy(TOY_URDF.replace(box, geometry), meshes=(mesh,), **changes)


@pytest.mark.parametrize(
    ("collision", "count"),
    [
        ({}, 2),
        ({"pieces": 1}, 1),
        ({"pieces": 1, "links": {"arm": {"pieces": 3, "tolerance": 0.0005}}}, 2),
        ({"tolerance": 0.2}, 1),
        ({"tolerance": 0.2, "links": {"arm": {"tolerance": 0.004}}}, 2),
        ({"links": {"left": {"pieces": 1}}}, 2),
    ],
    ids=str,
)
def test_robot_file_says_how_closely(make_toy: RobotFactory, tmp_path: Path, collision: Any, count: int) -> None:
    robot = with_bracket(make_toy, bracket(tmp_path), collision=collision)
    pieces = [solid for solid in link_solids(robot) if solid.name == "arm"]
    assert len(pieces) >= count if count > 1 else len(pieces) == 1
    points = np.concatenate([np.array(solid.shape.points()) for solid in pieces])
    np.testing.assert_allclose(np.ptp(points, axis=0), [0.2, 0.2, 0.05], atol=1e-7)


def test_unknown_link(make_toy: RobotFactory) -> None:
    with pytest.raises(InputError) as caught:
        make_toy(collision={"links": {"lefd": {"pieces": 2}}})
    assert caught.value.key == "collision.links.lefd"
    assert caught.value.remedy == "Did you mean left?"


@pytest.mark.parametrize(
    ("collision", "key"),
    [
        ({"pieces": 0}, "collision.pieces"),
        ({"pieces": True}, "collision.pieces"),
        ({"pieces": 2.5}, "collision.pieces"),
        ({"tolerance": 0.0}, "collision.tolerance"),
        ({"parts": 3}, "collision.parts"),
        ({"links": {"arm": {"pieces": -1}}}, "collision.links.arm.pieces"),
        ({"links": {"arm": 3}}, "collision.links.arm"),
    ],
    ids=str,
)
def test_collision_block_that_makes_no_sense(make_toy: RobotFactory, collision: Any, key: str) -> None:
    with pytest.raises(InputError) as caught:
        make_toy(collision=collision)
    assert caught.value.key == key


@pytest.mark.parametrize(
    ("geometry", "problem"),
    [
        ("<geometry><box/></geometry>", "size of a <box> has 0 numbers, not 3"),
        ('<geometry><box size="0.1 0.2"/></geometry>', "has 2 numbers, not 3"),
        ('<geometry><cylinder radius="0.1"/></geometry>', "length of a <cylinder> has 0 numbers"),
        ('<geometry><sphere radius="wide"/></geometry>', "'wide' is not a number"),
        ('<geometry><sphere radius="-0.1"/></geometry>', "not positive"),
        ('<origin xyz="1 2"/><geometry><sphere radius="0.1"/></geometry>', "xyz of <origin> has 2 numbers, not 3"),
    ],
)
def test_collision_element_that_others_pass_over_is_refused(
    make_toy: RobotFactory, geometry: str, problem: str
) -> None:
    urdf = TOY_URDF.replace('<link name="arm">', f'<link name="arm"><collision>{geometry}</collision>')
    with pytest.raises(InputError, match=problem.replace("(", r"\(")) as caught:
        link_solids(make_toy(urdf))
    assert caught.value.key == "link arm"


# ---- the cache


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Path]]:
    """An empty cache folder; yields the meshes that are read from now on."""
    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path / "cache"))
    temporary = TemporaryDirectory(dir=tmp_path)
    monkeypatch.setattr(cache_folder, "_temporary", cache(lambda: temporary))
    cover_cache._cached.cache_clear()
    read: list[Path] = []
    reader = cover_cache.read_triangles
    monkeypatch.setattr(cover_cache, "read_triangles", lambda mesh, scale: (read.append(mesh), reader(mesh, scale))[1])
    yield read
    cover_cache._cached.cache_clear()
    temporary.cleanup()


MILLI = (1e-3, 1e-3, 1e-3)


def anew(mesh: Path, scale: tuple[float, ...] = MILLI, pieces: int = 2, tolerance: float = TOLERANCE) -> list[Array]:
    """Return the pieces of a mesh as another process would get them."""
    cover_cache._cached.cache_clear()
    return list(mesh_cover(mesh, scale, pieces, tolerance))


def same(first: Sequence[Array], second: Sequence[Array]) -> bool:
    return len(first) == len(second) and all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))


def test_a_cached_cover_is_not_computed_again(own_cache: list[Path], tmp_path: Path) -> None:
    mesh = bracket(tmp_path)
    first = anew(mesh)
    assert len(own_cache) == 1
    assert same(anew(mesh), first)
    moved = shutil.copy(mesh, tmp_path / "cache" / mesh.name)
    assert same(anew(Path(moved)), first)
    assert len(own_cache) == 1
    assert len(first) == 2


def test_what_decides_the_pieces_is_in_the_key(
    own_cache: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mesh = bracket(tmp_path)
    anew(mesh)
    changes: list[dict[str, Any]] = [{"scale": (1e-3, 1e-3, 2e-3)}, {"pieces": 1}, {"tolerance": 0.005}]
    for count, change in enumerate(changes, 2):
        anew(mesh, **change)
        assert len(own_cache) == count
    monkeypatch.setattr(cover_cache, "VERSION", -1)
    anew(mesh)
    assert len(own_cache) == 5
    mesh.write_bytes(mesh.read_bytes()[:80] + b"\x00" + mesh.read_bytes()[81:])  # one triangle count, another file
    with pytest.raises(InputError):
        anew(mesh)


@pytest.mark.parametrize("damage", ["empty", "cut", "flipped", "text", "another archive", "folder"])
def test_a_damaged_file_is_computed_again(own_cache: list[Path], tmp_path: Path, damage: str) -> None:
    mesh = bracket(tmp_path)
    first = anew(mesh)
    [file] = (tmp_path / "cache" / "covers").iterdir()
    content = file.read_bytes()
    if damage == "another archive":
        np.savez(file, corners=np.zeros(3))
    elif damage == "folder":
        file.unlink()
        file.mkdir()
    else:
        middle = len(content) // 2
        flipped = content[:middle] + bytes([content[middle] ^ 255]) + content[middle + 1 :]
        file.write_bytes({"empty": b"", "cut": content[:middle], "flipped": flipped, "text": b"no archive"}[damage])
    assert same(anew(mesh), first)
    assert len(own_cache) == 2
    assert same(anew(mesh), first)
    assert len(own_cache) == 2
    assert [left.name for left in file.parent.iterdir()] == [file.name]


def test_a_folder_that_cannot_be_written_costs_time_only(
    own_cache: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mesh = bracket(tmp_path)
    first = anew(mesh)
    monkeypatch.setenv("PINOGRASP_CACHE", str(mesh))  # a file
    with pytest.warns(CacheWarning, match=r"bracket.*PINOGRASP_CACHE"):
        assert same(anew(mesh), first)
    assert len(own_cache) == 2
    # In one process, and in what is forked from it, once is enough.
    assert same(mesh_cover(mesh, MILLI, 2, TOLERANCE), first)
    assert len(own_cache) == 2


def test_a_robot_with_cached_covers_reads_no_mesh(
    make_toy: RobotFactory, own_cache: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = with_bracket(make_toy, bracket(tmp_path))
    first = link_solids(robot)
    assert len(own_cache) == 1
    cover_cache._cached.cache_clear()
    again = link_solids(Robot(robot.description))
    assert len(own_cache) == 1
    for one, other in zip(first, again, strict=True):
        assert one.name == other.name
        np.testing.assert_array_equal(one.placement, other.placement)
        if isinstance(one.shape, coal.ConvexBase):
            np.testing.assert_array_equal(np.array(one.shape.points()), np.array(other.shape.points()))


@pytest.mark.parametrize("content", [b"", b"solid nothing", b"\x00" * 84], ids=["empty", "text", "no triangles"])
def test_a_mesh_that_cannot_be_used_is_named(own_cache: list[Path], tmp_path: Path, content: bytes) -> None:
    mesh = tmp_path / "broken.stl"
    mesh.write_bytes(content)
    with pytest.raises(InputError) as caught:
        anew(mesh)
    assert caught.value.file == mesh
    missing = tmp_path / "missing.stl"
    with pytest.raises(InputError) as caught:
        anew(missing)
    assert caught.value.file == missing
