"""Painted regions: what is painted in mesh files, how deep points are in it, and grasps that keep to it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image
from places import project

import pinograsp
from pinograsp import Mesh, Painted
from pinograsp.descriptions.regions import AllOf, AnyOf, HalfSpace, Outside, on_object
from pinograsp.descriptions.shapes import Sphere
from pinograsp.errors import FileError, InputError
from pinograsp.geometry.regions import membership
from pinograsp.problem import GraspProblem, TaskModel
from pinograsp.problem.constraints.contact_region import contact_region
from pinograsp.problem.constraints.footprint_region import FootprintRegion
from pinograsp.problem.mesh_findings import mesh_findings
from pinograsp.verification.painted import painted_depths
from pinograsp.verification.region_depth import least_depth
from pinograsp.verification.regions import depth

RADIUS, HEIGHTS = 0.0423, (-0.059, -0.03, 0.0, 0.034, 0.059)
"""Of the paper's can, m; contact is allowed in the highest ring of its side."""
GREEN, GRAY = (0, 200, 0), (150, 150, 150)


def can(sides: int = 180) -> tuple[Any, Any, Any]:
    """Return corners, triangles, and which of them are painted."""
    angles = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    circle = RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])
    rings = [np.column_stack([circle, np.full(sides, z)]) for z in HEIGHTS]
    corners = np.vstack([*rings, [[0, 0, HEIGHTS[0]], [0, 0, HEIGHTS[-1]]]])
    k, after, last = np.arange(sides), (np.arange(sides) + 1) % sides, sides * (len(HEIGHTS) - 1)
    sheets = [
        np.vstack(
            [
                np.column_stack([r + k, r + after, r + sides + after]),
                np.column_stack([r + k, r + sides + after, r + sides + k]),
            ]
        )
        for r in range(0, last, sides)
    ]
    bottom = np.column_stack([np.full(sides, len(corners) - 2), after, k])
    top = np.column_stack([np.full(sides, len(corners) - 1), last + k, last + after])
    faces = np.vstack([*sheets, bottom, top])
    painted = np.zeros(len(faces), dtype=bool)
    painted[3 * 2 * sides : 4 * 2 * sides] = True
    return corners, faces, painted


CORNERS, FACES, PAINTED = can()


def bare(faces: Any) -> Any:
    return trimesh.Trimesh(CORNERS, faces, process=False)


def write_ply(file: Path) -> None:
    mesh = bare(FACES)
    mesh.visual.face_colors = np.where(PAINTED[:, None], [*GREEN, 255], [*GRAY, 255]).astype(np.uint8)
    mesh.export(file)


def write_obj(file: Path) -> None:
    lines = ["v {} {} {}".format(*map(repr, corner)) for corner in CORNERS.tolist()]
    for name, chosen in (("grip", PAINTED), ("rest", ~PAINTED)):
        lines += [f"usemtl {name}", f"g {name}s all"]
        lines += ["f {} {} {}".format(*face) for face in (FACES[chosen] + 1).tolist()]
    file.write_text("\n".join(lines))


def write_glb(file: Path) -> None:
    scene = trimesh.Scene()
    for name, chosen in (("grip", PAINTED), ("rest", ~PAINTED)):
        part = bare(FACES[chosen])
        part.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.PBRMaterial(name=name))
        scene.add_geometry(part, geom_name=f"{name} mesh", node_name=f"{name} node")
    scene.export(file)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cans")
    write_ply(folder / "can.ply")
    write_obj(folder / "can.obj")
    write_glb(folder / "can.glb")
    bare(FACES).export(folder / "bare.stl")
    return folder


WAYS: list[dict[str, Any]] = [
    {"file": "can.ply", "color": GREEN},
    {"file": "can.ply", "color": "#05c80a"},
    {"file": "can.obj", "material": "grip"},
    {"file": "can.obj", "group": "grips"},
    {"file": "can.obj", "group": "all", "material": "grip"},
    {"file": "can.glb", "material": "grip"},
    {"file": "can.glb", "group": "grip mesh"},
    {"file": "can.glb", "group": "grip node"},
]


def painted(folder: Path, way: dict[str, Any]) -> Painted:
    return Painted(**{**way, "file": folder / way["file"]})


def around(count: int, heights: tuple[float, float] = (-0.05, 0.055)) -> Any:
    """Return points a tenth of a millimetre off the side of the can."""
    rng = np.random.default_rng(0)
    angles, z = rng.uniform(0, 2 * np.pi, count), rng.uniform(*heights, count)
    return np.column_stack([(RADIUS + 1e-4) * np.cos(angles), (RADIUS + 1e-4) * np.sin(angles), z])


@pytest.mark.parametrize("way", WAYS, ids=str)
def test_depths_are_those_of_the_ring(way: dict[str, Any], folder: Path) -> None:
    region, points = painted(folder, way), around(200)
    values, gradients = membership(region)(points)
    expected = np.minimum(points[:, 2] - HEIGHTS[3], HEIGHTS[4] - points[:, 2])
    np.testing.assert_allclose(values, expected, atol=1e-8)
    np.testing.assert_allclose(painted_depths(region, points), expected, atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(gradients, axis=1), 1.0, atol=1e-6)


@pytest.mark.parametrize("beyond", [0.003, -0.002])
def test_regions_reach_beyond_the_paint(beyond: float, folder: Path) -> None:
    region, points = painted(folder, WAYS[0] | {"beyond": beyond}), around(200)
    expected = np.minimum(points[:, 2] - HEIGHTS[3], HEIGHTS[4] - points[:, 2]) + beyond
    np.testing.assert_allclose(membership(region)(points)[0], expected, atol=1e-8)
    np.testing.assert_allclose(painted_depths(region, points), expected, atol=1e-8)
    plain = membership(painted(folder, WAYS[0]))(points)[1]
    np.testing.assert_allclose(membership(region)(points)[1], plain, atol=1e-12)


def test_gradient_of_membership(folder: Path) -> None:
    function, points = membership(painted(folder, WAYS[0])), around(50)
    differences = [(function(points + step)[0] - function(points - step)[0]) / 2e-7 for step in 1e-7 * np.eye(3)]
    np.testing.assert_allclose(function(points)[1], np.transpose(differences), atol=1e-6)


def test_on_the_border_the_gradient_leads_into_the_paint(folder: Path) -> None:
    values, gradients = membership(painted(folder, WAYS[2]))(np.array([[RADIUS, 0.0, HEIGHTS[3]]]))
    assert values[0] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(gradients[0], [0, 0, 1], atol=1e-6)


def test_combinations(folder: Path) -> None:
    ring = painted(folder, WAYS[0])
    front = HalfSpace(normal=(1, 0, 0), offset=0.0)
    inside, below = np.array([RADIUS, 0, 0.045]), np.array([RADIUS, 0, 0.02])
    for region, holds in (
        (AllOf(parts=(ring, front)), (True, False)),
        (AllOf(parts=(ring, Outside(part=front))), (False, False)),
        (AnyOf(parts=(ring, front)), (True, True)),
        (Outside(part=ring), (False, True)),
    ):
        for point, inside_it in zip((inside, below), holds, strict=True):
            assert (depth(region, point) > 0.0) == inside_it
            assert (membership(region)(point[None])[0][0] > 0.0) == inside_it


def test_least_depth_of_a_line(folder: Path) -> None:
    line = np.array([[RADIUS, 0, 0.035], [RADIUS, 0, 0.055]])
    assert least_depth(painted(folder, WAYS[0]), line) == pytest.approx(0.001, abs=2e-6)


def test_two_of_three_corners_have_the_colour(tmp_path: Path) -> None:
    """Corners of the box above z = 0 are painted: of every side one triangle has two of them, the other has one."""
    mesh = trimesh.creation.box(extents=[0.04, 0.04, 0.04])
    mesh.visual.vertex_colors = np.where(mesh.vertices[:, 2:] > 0, [*GREEN, 255], [*GRAY, 255]).astype(np.uint8)
    mesh.export(tmp_path / "box.ply")
    region = Painted(file=tmp_path / "box.ply", color=GREEN)
    most = (mesh.vertices[mesh.faces][:, :, 2] > 0).sum(axis=1) >= 2
    assert 0 < most.sum() < len(most)
    centers = mesh.triangles_center
    np.testing.assert_array_equal(membership(region)(centers)[0] > 0.0, most)
    np.testing.assert_array_equal(painted_depths(region, centers) > 0.0, most)


def test_textures_are_looked_at_in_the_middle_of_triangles(tmp_path: Path) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=0.03)
    image = Image.new("RGB", (2, 64), GRAY)
    image.paste(GREEN, (0, 0, 2, 32))  # the upper half, which is that of v > 0.5
    uv = np.column_stack([np.full(len(mesh.vertices), 0.5), 0.5 + mesh.vertices[:, 2] / 0.0601])
    mesh.visual = trimesh.visual.TextureVisuals(
        uv=uv, material=trimesh.visual.material.PBRMaterial(baseColorTexture=image)
    )
    mesh.export(tmp_path / "ball.glb")
    region = Painted(color=GREEN)
    content = pinograsp.load_scene("glovebox").to_dict()
    content["objects"]["sphere"]["shape"] = {"type": "mesh", "file": str(tmp_path / "ball.glb")}
    content["tasks"]["sphere"]["allowed_contacts"] = {"type": "painted", "color": list(GREEN)}
    scene = pinograsp.Scene.from_dict(content)
    region = scene.region_of(scene.task("sphere"))
    assert isinstance(region, Painted)
    heights = mesh.triangles_center[:, 2]
    clear = np.abs(heights) > 0.003
    values = membership(region)(mesh.triangles_center)[0]
    np.testing.assert_array_equal(values[clear] > 0.0, heights[clear] > 0.0)
    np.testing.assert_allclose(painted_depths(region, mesh.triangles_center), values, atol=1e-7)
    said = list(mesh_findings(scene, scene.task("sphere")))
    assert said == ["painted with color '#00c800': colours of the texture in the middle of each triangle were taken"]


def test_paint_of_the_objects_own_mesh(folder: Path) -> None:
    shape = Mesh(file=folder / "can.obj", scale=2.0, unit="m", largest_hole=0.001)
    region = on_object(AllOf(parts=(Painted(material="grip"), Outside(part=Painted(group="rests")))), shape)
    assert isinstance(region, AllOf)
    own = region.parts[0]
    assert isinstance(own, Painted)
    assert (own.file, own.scale, own.unit, own.sha256) == (shape.file, 2.0, "m", shape.sha256)
    assert own.mesh == shape
    assert membership(region)(2.0 * around(1, (0.045, 0.046)))[0][0] > 0.01


@pytest.mark.parametrize(
    ("region", "words"),
    [
        ({"color": "red"}, "'red' is no colour"),
        ({"color": [0, 300, 0]}, "less than or equal to 255"),
        ({"color": [0, 0.5, 0]}, "integer"),
        ({}, "nothing says what is painted"),
        ({"material": "grip", "unit": "mm"}, "unit: belongs to a `file`"),
        ({"material": "grip", "file": "none.obj"}, "cannot be read"),
    ],
)
def test_senseless_regions_are_refused(region: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Painted(**region)


@pytest.mark.parametrize(
    ("way", "words"),
    [
        (
            {"file": "can.ply", "color": (255, 0, 0)},
            "has nothing that is painted with color '#ff0000'. Its colours: #969696, #00c800",
        ),
        (
            {"file": "can.glb", "color": GREEN},
            "with color '#00c800'. No triangle has a colour of its own; what a material colours is chosen with "
            "`material`: grip, rest",
        ),
        ({"file": "bare.stl", "color": GREEN}, "No triangle has a colour; PLY files keep colours of faces"),
        ({"file": "bare.stl", "material": "grip"}, "with material 'grip'. It has no materials"),
        ({"file": "can.obj", "material": "grap"}, "with material 'grap'. Did you mean grip?"),
        ({"file": "can.obj", "material": "x"}, "with material 'x'. Its materials: grip, rest"),
        ({"file": "can.glb", "group": "x"}, "with group 'x'. Its groups: grip mesh, grip node, rest mesh, rest node"),
        (
            {"file": "can.obj", "material": "grip", "group": "rests"},
            "with material 'grip' and group 'rests'. Each is there, but no triangle has both; an `any_of` of regions "
            "takes what has either",
        ),
        ({"file": "can.ply", "color": GREEN, "material": "grip"}, "and material 'grip'. It has no materials"),
        ({"file": "can.obj", "color": GREEN, "material": "grip"}, "is chosen with `material`: grip, rest"),
    ],
)
def test_what_is_not_painted_is_refused_with_what_is(way: dict[str, Any], words: str, folder: Path) -> None:
    with pytest.raises(FileError) as caught:
        membership(painted(folder, way))
    assert words in str(caught.value)


def test_paint_of_the_objects_own_mesh_keeps_how_far_it_reaches(folder: Path) -> None:
    mesh = Mesh(file=folder / "can.ply")
    region = on_object(Painted(color=GREEN, beyond=0.004), mesh)
    assert isinstance(region, Painted)
    assert (region.file, region.beyond) == (mesh.file, 0.004)


def test_an_object_that_is_no_mesh_has_no_paint_of_its_own() -> None:
    with pytest.raises(InputError, match="nothing is painted on an object of type sphere"):
        on_object(Painted(color=GREEN), Sphere(radius=0.03))
    scene = pinograsp.load_scene("glovebox_can")
    with pytest.raises(InputError) as caught:
        scene.with_task("can", forbidden_contacts=Painted(color=GREEN))
    assert caught.value.key == "tasks.can.forbidden_contacts"


def test_paint_on_a_described_cylinder_is_the_band(gen3: Any, folder: Path) -> None:
    """The paper's case 3, its band painted in another file."""
    scene = pinograsp.load_scene("glovebox_can")
    ring = scene.with_task("can_region", allowed_contacts=painted(folder, WAYS[0]))
    found, expected = (pinograsp.plan(gen3, s, "can_region", starts=4, workers=1) for s in (ring, scene))
    assert found.verified == expected.verified == 4
    assert found.best is not None and expected.best is not None
    assert pytest.approx(expected.best.cost.U, rel=1e-4) == found.best.cost.U
    assert pinograsp.verify(found) == ()


def test_the_painted_can_is_case_3(gen3: Any, folder: Path) -> None:
    """The can itself as a mesh: the same U within 1 %, by contact points as in the paper."""
    scene = pinograsp.load_scene("glovebox_can")
    body = scene.objects["can"].model_copy(update={"shape": Mesh(file=folder / "can.ply")})
    mesh = scene.with_object("can", body).with_task("can_region_point", allowed_contacts=Painted(color=GREEN))
    found, expected = (pinograsp.plan(gen3, s, "can_region_point", starts=4, workers=1) for s in (mesh, scene))
    assert found.verified == 4
    assert found.best is not None and expected.best is not None
    assert pytest.approx(expected.best.cost.U, rel=0.01) == found.best.cost.U


@pytest.fixture(scope="module")
def painted_can(folder: Path) -> Any:
    scene = pinograsp.load_scene("glovebox_can")
    body = scene.objects["can"].model_copy(update={"shape": Mesh(file=folder / "can.ply")})
    return scene.with_object("can", body).with_task("can_region", allowed_contacts=Painted(color=GREEN))


def test_the_painted_can_is_case_3_by_footprints(gen3: Any, painted_can: Any) -> None:
    """Desired contacts are 34 mm outside: pads slide into the paint, and are not lifted off the rest."""
    found = pinograsp.plan(gen3, painted_can, "can_region", starts=4, workers=1)
    expected = pinograsp.plan(gen3, pinograsp.load_scene("glovebox_can"), "can_region", starts=4, workers=1)
    assert (found.verified, found.refuted) == (4, 0)
    assert found.best is not None and expected.best is not None
    assert pytest.approx(expected.best.cost.U, rel=0.01) == found.best.cost.U


def test_footprints_have_the_slopes_of_their_differences(gen3: Any, painted_can: Any) -> None:
    """Rows whose least value is between points of the grid have them but for a part of second order.

    A value jumps where what is below a point turns away from the pad; no more than one of the rows does so here.
    """
    problem = GraspProblem(TaskModel(gen3, painted_can, "can_region"), (0, 1))
    middle = 0.5 * (problem.lower + problem.upper)
    place, region = project(problem, middle, "contacts and clearance"), contact_region(problem.model)
    assert isinstance(region, FootprintRegion)
    rng, step = np.random.default_rng(0), 1e-6
    for _ in range(4):
        x = np.clip(place + 0.01 * rng.normal(size=len(place)), problem.lower, problem.upper)
        jacobian = region.inside(problem.state(x)).jacobian
        along = rng.normal(size=len(x))
        after, before = (region.inside(problem.state(x + sign * step * along)).values for sign in (1.0, -1.0))
        smooth = np.abs(after - before) < 1e-4
        assert (~smooth).sum() <= 1
        difference = ((after - before) / (2.0 * step))[smooth]
        np.testing.assert_allclose((jacobian @ along)[smooth], difference, rtol=0.02, atol=0.02)


def test_a_pad_that_touches_nothing_is_in_every_region_but_for_its_contact_point(gen3: Any, painted_can: Any) -> None:
    away = painted_can.with_object_pose("can", pinograsp.Pose(position=(5.0, 0.0, 0.0)))
    problem = GraspProblem(TaskModel(gen3, away, "can_region"), (0, 1))
    region = contact_region(problem.model)
    assert region is not None
    values, jacobian = region.inside(problem.state(0.5 * (problem.lower + problem.upper)))
    of_cells = np.arange(len(values)) % 17 > 0
    assert (values[of_cells] > 0.0).all()
    assert (jacobian[of_cells] == 0.0).all()


def test_content_of_a_file_is_read_as_it_was_written(folder: Path) -> None:
    scene = pinograsp.load_scene("glovebox_can")
    body = scene.objects["can"].model_copy(update={"shape": Mesh(file=folder / "can.ply")})
    mesh = scene.with_object("can", body).with_task("can", allowed_contacts=Painted(color=GREEN))
    assert type(mesh).from_dict(mesh.to_dict()) == mesh
    assert type(mesh).model_validate(mesh.model_dump(mode="json")) == mesh  # as files of results have it


def test_what_is_read_is_what_was_hashed(folder: Path, tmp_path: Path) -> None:
    file = tmp_path / "can.ply"
    file.write_bytes((folder / "can.ply").read_bytes())
    region = Painted(file=file, color=GREEN)
    file.write_bytes((folder / "can.ply").read_bytes() + b" ")
    for read in (lambda: membership(region), lambda: painted_depths(region, np.zeros((1, 3)))):
        with pytest.raises(FileError, match="is not the file that the scene was made with"):
            read()
