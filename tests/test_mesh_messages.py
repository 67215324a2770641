"""Faults of mesh files, told so that they can be mended."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
import yaml
from meshes import ball

import pinograsp
from pinograsp import Robot, Scene
from pinograsp.descriptions.mesh_files import mesh_bytes
from pinograsp.descriptions.shapes import Mesh
from pinograsp.errors import FileError
from pinograsp.geometry.filled import filled
from pinograsp.geometry.object_mesh import object_mesh
from pinograsp.verification.object_mesh import object_mesh as checked_mesh


def _file(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


@pytest.mark.parametrize(("colors", "words"), [("red green", "blue"), ("blue", "green and red"), ("green blue", "red")])
@pytest.mark.parametrize("element", ["vertex", "face"])
def test_ply_without_a_colour(colors: str, words: str, element: str, tmp_path: Path) -> None:
    lines = "".join(f"property uchar {name}\n" for name in colors.split())
    head = ball(0.03).export(file_type="ply").partition(b"end_header")[0].decode()
    before = "element face" if element == "vertex" else "end_header"
    head = (head + "end_header\n").replace(before, lines + before)
    with pytest.raises(FileError) as caught:
        object_mesh(Mesh(file=_file(tmp_path / "ball.ply", head.encode())))
    assert caught.value.problem == f"has colours without {words} in its element {element}"
    assert caught.value.remedy == "Export it again, with red, green and blue or without colours"
    assert str(tmp_path / "ball.ply") in str(caught.value)


def test_a_binary_stl_that_is_cut_off(tmp_path: Path) -> None:
    whole = ball(0.03).export(file_type="stl")
    count = (len(whole) - 84) // 50
    half = 84 + 50 * (count // 2) + 7
    with pytest.raises(FileError) as caught:
        object_mesh(Mesh(file=_file(tmp_path / "ball.stl", whole[:half])))
    assert caught.value.problem == f"is cut off: {count // 2} of {count} triangles are there"
    assert caught.value.remedy == "Copy or export it again"


OFF = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
PLY = ball(0.03, 1).export(file_type="ply", encoding="ascii")
BINARY = ball(0.03, 1).export(file_type="ply")
DAE = ball(0.03, 1).export(file_type="dae")
STL = trimesh.exchange.stl.export_stl_ascii(ball(0.03, 1)).encode()


def glb(change: Callable[[dict[str, Any]], object]) -> bytes:
    """Return a GLB file with something changed in its JSON part."""
    whole = ball(0.03, 1).export(file_type="glb")
    size = int.from_bytes(whole[12:16], "little")
    tree = json.loads(whole[20 : 20 + size])
    change(tree)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = len(text).to_bytes(4, "little") + b"JSON" + text + whole[20 + size :]
    return bytes(whole[:8]) + (12 + len(rest)).to_bytes(4, "little") + rest


DAMAGED = {
    "word.off": (b"hello", "it does not begin with OFF"),
    "bare.off": (b"OFF\n", "the numbers of its corners and faces should follow OFF, and nothing does"),
    "counts.off": (b"OFF\nmany\n", "the numbers of its corners and faces should follow OFF, and 'many' does"),
    "corner.off": (OFF.replace(b"\n0 1 0", b"\n0 b 0"), "corner 2, counted from 0, is not three numbers: '0 b 0'"),
    "range.off": (OFF.replace(b"3 1 2 3", b"3 1 2 4"), "face 3, counted from 0, has the corner 4, of 4"),
    "short.off": (
        OFF.replace(b"3 1 2 3", b"3 1 x 3"),
        "face 3, counted from 0, is no number of corners and so many corners: '3 1 x 3'",
    ),
    "word.dae": (b"hello", "it is XML that ends or breaks in line 1, column 1"),
    "page.dae": (b"<html><body/></html>", "it is XML of another kind: <html>, not <COLLADA>"),
    "lost.dae": (re.sub(b'url="#[^"]*"', b'url="#gone"', DAE), "it refers to '#gone', which it does not define"),
    "word.ply": (b"hello", "it does not begin with ply"),
    "header.ply": (b"ply\nhello", "its header has a line that is not understood, or no end_header"),
    "type.ply": (
        PLY.replace(b"float z", b"foo z"),
        "its header has a line that is not understood, or no end_header",
    ),
    "flat.ply": (PLY.replace(b"property float z\n", b""), "its vertices have no z"),
    "row.ply": (
        PLY.replace(b"end_header\n", b"end_header\na b c\n"),
        "vertex 0, counted from 0, is not numbers alone: ",
    ),
    "cut.ply": (BINARY[:-9], "it is cut off: 1535 bytes follow its header, which announces 1544"),
    "long.ply": (BINARY + b"xx", "1546 bytes follow its header, which announces 1544"),
    "word.glb": (b"hello", "it does not begin with glTF"),
    "cut.glb": (glb(dict)[:100], f"it is cut off: 100 of {len(glb(dict))} bytes are there"),
    "json.glb": (glb(dict).replace(b"{", b"x", 1), "its JSON part is damaged at character 0 of "),
    "accessor.glb": (glb(lambda tree: tree.pop("accessors")), "POSITION of mesh 0 is accessor 1, of 0"),
    "beyond.glb": (
        glb(lambda tree: tree["accessors"][0].update(count=10**6)),
        "accessor 0 has 1000000 entries, of 4 bytes, in 960 bytes",
    ),
    "type.glb": (
        glb(lambda tree: tree["accessors"][0].update(componentType=77)),
        "accessor 0 has numbers of an unknown type",
    ),
    "view.glb": (
        glb(lambda tree: tree["bufferViews"][0].update(byteLength=10**6)),
        "bufferView 0 ends at byte 1000000 of 1464",
    ),
    "vertex.stl": (STL.replace(b"vertex ", b"vertex x", 1), "line 4 is not a corner of three numbers: 'vertex x"),
    "words.obj": (b"v a b c\nf 1 2 3\n", "vertex 1 is not three numbers: 'a b c'"),
    "two.obj": (b"v 0 0 0\nv 1 0 0\nf 1 2\n", "face 1 has fewer than three corners: '1 2'"),
    "large.obj": (b"v 0 0 0\nf 1 1 1\nf 1 1 " + b"9" * 30, "face 2 is not numbers of vertices: '1 1 999"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damage_is_told_in_words(name: str, tmp_path: Path) -> None:
    """Not in those of a parser."""
    content, words = DAMAGED[name]
    with pytest.raises(FileError) as caught:
        object_mesh(Mesh(file=_file(tmp_path / name, content)))
    assert caught.value.problem.startswith(f"cannot be read as {name[-3:].upper()}: {words}")
    assert caught.value.remedy


def test_a_polygon_of_more_corners_than_there_are_is_refused_before_room_is_asked_for(tmp_path: Path) -> None:
    """pycollada would ask for 300 GB."""
    for tag in (b"vcount", b"c:vcount"):
        file = _file(tmp_path / "many.dae", DAE + b"<%b>3 4444 44444444444</%b>" % (tag, tag))
        with pytest.raises(FileError, match=r"a polygon of 4.44e\+10 corners \(<vcount>\), in \d+ bytes"):
            mesh_bytes(file)
    mesh_bytes(_file(tmp_path / "few.dae", DAE + b"<vcount>3 4 7</vcount>"))


def with_first_corner(text: bytes) -> bytes:
    """Return a COLLADA file with something else in the place of its first coordinate."""
    return re.sub(rb"(<float_array[^>]*>)[^ <]+", rb"\g<1>" + text, DAE, count=1)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (with_first_corner(b"nan"), r"has the coordinate nan, number 1 of "),
        (with_first_corner(b"-inf"), r"has the coordinate -inf, number 1 of "),
        (re.sub(rb"<p>[^ <]+", b"<p>-1", DAE, count=1), r"has the index -1 among those of its corners \(<p>\)"),
        (DAE.replace(b"<asset>", b'<asset><unit name="x" meter="nan"/>', 1), r"states a unit of 'nan' m"),
        (DAE.replace(b"<asset>", b"<asset><unit meter='cm'/>", 1), r"states a unit of 'cm' m"),
        (DAE.replace(b"<asset>", b'<asset><unit meter="-1"/>', 1), r"states a unit of '-1' m"),
    ],
)
def test_what_the_parser_of_collada_passes_over(content: bytes, words: str, tmp_path: Path) -> None:
    """It makes 0 of corners that are no numbers, counts -1 from the end, and takes metres for what is no unit."""
    assert content != DAE
    with pytest.raises(FileError, match=words):
        mesh_bytes(_file(tmp_path / "odd.dae", content))
    mesh_bytes(_file(tmp_path / "sound.dae", DAE.replace(b"<asset>", b'<asset><unit name="inch" meter="0.0254"/>', 1)))


@pytest.mark.parametrize("name", ["row.ply", "cut.ply", "lost.dae", "range.off", "json.glb"])
def test_the_verification_and_the_centre_of_mass_tell_the_same(name: str, tmp_path: Path) -> None:
    content, words = DAMAGED[name]
    shape = Mesh(file=_file(tmp_path / name, content))
    for read in (checked_mesh, filled):
        with pytest.raises(FileError) as caught:
            read(shape)
        assert caught.value.problem.startswith(f"cannot be read as {name[-3:].upper()}: {words}")


def test_a_text_stl_that_is_cut_off(tmp_path: Path) -> None:
    """Of two parts, too: the parser would take the first alone."""
    for content in (STL[: len(STL) // 2], STL + STL[: len(STL) // 2]):
        with pytest.raises(FileError, match="is cut off: its last part has no endsolid"):
            object_mesh(Mesh(file=_file(tmp_path / "ball.stl", content)))


def colored(kind: str, form: str, element: str, color: tuple[float, ...]) -> bytes:
    """Return a PLY file of a ball, black but for one vertex or face, the seventh, counted from 0."""
    mesh, of = ball(0.03, 1), np.dtype({"uchar": "u1", "int": "<i4", "float": "<f4"}[kind])
    black = np.zeros((len(mesh.vertices if element == "vertex" else mesh.faces), 3), dtype=of)
    told = [list[str](map(str, color if row == 7 else (0, 0, 0))) for row in range(len(black))]
    names = "".join(f"property {kind} {name}\n" for name in ("red", "green", "blue"))
    head = f"ply\nformat {form} 1.0\nelement vertex {len(mesh.vertices)}\n"
    head += "".join(f"property float {name}\n" for name in "xyz") + (names if element == "vertex" else "")
    head += f"element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\n"
    head += (names if element == "face" else "") + "end_header\n"
    corners, faces = mesh.vertices.astype("<f4"), mesh.faces.astype("<i4")
    if form == "ascii":
        rows = [" ".join(map(str, row)) for row in corners.tolist()]
        sides = ["3 " + " ".join(map(str, row)) for row in faces.tolist()]
        painted = rows if element == "vertex" else sides
        painted[:] = [f"{row} {' '.join(words)}" for row, words in zip(painted, told, strict=True)]
        return (head + "\n".join(rows + sides) + "\n").encode()
    black[7] = color
    parts = [row.tobytes() for row in corners], [b"\3" + row.tobytes() for row in faces]
    chosen = parts[0 if element == "vertex" else 1]
    chosen[:] = [row + paint.tobytes() for row, paint in zip(chosen, black, strict=True)]
    return head.encode() + b"".join(parts[0] + parts[1])


@pytest.mark.parametrize("element", ["vertex", "face"])
@pytest.mark.parametrize(
    ("kind", "form", "color", "words"),
    [
        ("uchar", "ascii", (300, 0, 0), "red 300"),
        ("uchar", "ascii", (0, -1, 0), "green -1"),
        ("float", "ascii", (0, 0, 7.0), "blue 7"),
        ("float", "ascii", (0, math.nan, 0), "green nan"),
        ("int", "binary_little_endian", (0, 256, 0), "green 256"),
        ("float", "binary_little_endian", (7.0, 0, 0), "red 7"),
    ],
)
def test_colours_out_of_range(
    kind: str, form: str, color: tuple[float, ...], words: str, element: str, tmp_path: Path
) -> None:
    file = _file(tmp_path / "ball.ply", colored(kind, form, element, color))
    with pytest.raises(FileError) as caught:
        object_mesh(Mesh(file=file))
    assert caught.value.problem == f"has the colour {words} at {element} 7, counted from 0"
    assert "export it again" in str(caught.value.remedy)


@pytest.mark.parametrize("element", ["vertex", "face"])
@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
@pytest.mark.parametrize(("kind", "color"), [("uchar", (255, 9, 0)), ("int", (255, 9, 0)), ("float", (1.0, 0.0353, 0))])
def test_colours_in_range(kind: str, color: tuple[float, ...], form: str, element: str, tmp_path: Path) -> None:
    mesh = object_mesh(Mesh(file=_file(tmp_path / "ball.ply", colored(kind, form, element, color))))
    found = mesh.paint.colors[(mesh.paint.colors[:, :, 0] == 255).any(axis=1)].reshape(-1, 3)
    assert len(found) == (3 if element == "face" else 3 * 5)  # five triangles meet at it, painted at one corner each
    assert (found[found[:, 0] == 255] == (255, 9, 0)).all()


def test_colours_of_an_obj_file_go_to_one(tmp_path: Path) -> None:
    rows = [f"v {x} {y} {z} 0 0 0" for x, y, z in ball(0.03, 1).vertices.tolist()]
    rows[4] = rows[4].replace(" 0 0 0", " 0 128 0")
    faces = ["f " + " ".join(map(str, face)) for face in (ball(0.03, 1).faces + 1).tolist()]
    with pytest.raises(FileError, match=r"has the colour \(0, 128, 0\) at vertex 5"):
        object_mesh(Mesh(file=_file(tmp_path / "ball.obj", "\n".join(rows + faces).encode())))


# ---- Who asks for the file.

CONTENTS = {
    "empty.obj": (b"# nothing\n", "has no triangles"),
    "numbers.obj": (b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "has corners that are not finite"),
    "cut.off": (OFF[:35], "is cut off: it announces 4 corners and 4 faces, and 5 lines follow"),
    "flat.off": (b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", "encloses no volume"),
    "open.off": (OFF.replace(b"4 4 0", b"4 3 0"), "is not closed: it has a hole"),
}


@pytest.fixture
def written(glovebox: Scene, tmp_path: Path) -> Callable[..., Path]:
    """Write the shipped scene with parts of it changed, and a mesh beside it."""

    def write(name: str, where: str) -> Path:
        _file(tmp_path / name, CONTENTS[name][0])
        content, mesh = glovebox.to_dict(), {"type": "mesh", "file": name}
        task = content["tasks"]["sphere"]
        if where == "objects":
            content["objects"]["sphere"]["shape"] = mesh
            del task["desired_contacts"]
        elif where == "obstacles":
            content["obstacles"] = {"mug": {"shape": mesh}}
        elif where == "compound":
            content["obstacles"] = {"mug": {"shape": {"type": "compound", "parts": [{"shape": mesh}]}}}
        else:
            task["forbidden_contacts"] = {"type": "any_of", "parts": [{**mesh, "type": "painted", "color": "#ff0000"}]}
        content["tasks"] = {"sphere": task}
        scene = tmp_path / "scene.yaml"
        scene.write_text(yaml.safe_dump(content))
        return scene

    return write


@pytest.mark.parametrize(
    ("where", "key"),
    [
        ("objects", "objects.sphere.shape.file"),
        ("obstacles", "obstacles.mug.shape.file"),
        ("compound", "obstacles.mug.shape.parts[0].shape.file"),
        ("regions", "tasks.sphere.forbidden_contacts.parts[0].file"),
    ],
)
@pytest.mark.parametrize("name", CONTENTS)
def test_errors_of_content_name_scene_and_key(
    name: str, where: str, key: str, gen3: Robot, written: Callable[..., Path], tmp_path: Path
) -> None:
    file = written(name, where)
    with pytest.raises(FileError) as caught:
        pinograsp.contacts(gen3, pinograsp.load_scene(file), task="sphere")
    assert (caught.value.file, caught.value.key) == (file, key)
    assert caught.value.problem.startswith(f"{tmp_path / name} ")
    assert CONTENTS[name][1] in caught.value.problem
    assert caught.value.remedy


def test_a_database_names_the_obstacle(gen3: Robot, written: Callable[..., Path], tmp_path: Path) -> None:
    scene = pinograsp.load_scene(written("open.off", "obstacles"))
    with pytest.raises(FileError) as caught:
        pinograsp.build_database(gen3, scene, tmp_path / "starts.duckdb", size=10, workers=1)
    assert (caught.value.file, caught.value.key) == (scene.source, "obstacles.mug.shape.file")


def test_an_obstacle_that_is_drawn_is_named(gen3: Robot, written: Callable[..., Path], tmp_path: Path) -> None:
    scene = pinograsp.load_scene(written("open.off", "obstacles"))
    pair = pinograsp.contacts(gen3, pinograsp.load_scene("glovebox"), task="sphere", most=1)
    with pytest.raises(FileError) as caught:
        pinograsp.visualization.write_contacts_html(pair, scene, "sphere", tmp_path / "page.html")
    assert (caught.value.file, caught.value.key) == (scene.source, "obstacles.mug.shape.file")


def test_paint_that_is_not_there_is_told_with_the_region(gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    """Of the object's own mesh, which the region does not name."""
    content = glovebox.to_dict()
    _file(tmp_path / "ball.ply", colored("uchar", "ascii", "face", (255, 0, 0)))
    content["objects"]["sphere"]["shape"] = {"type": "mesh", "file": str(tmp_path / "ball.ply"), "unit": "m"}
    content["tasks"] = {
        "sphere": {**content["tasks"]["sphere"], "allowed_contacts": {"type": "painted", "color": "#00ff00"}}
    }
    del content["tasks"]["sphere"]["desired_contacts"]
    with pytest.raises(FileError) as caught:
        pinograsp.contacts(gen3, Scene.from_dict(content), task="sphere")
    assert caught.value.key == "tasks.sphere.allowed_contacts"
    assert caught.value.problem == f"{tmp_path / 'ball.ply'} has nothing that is painted with color '#00ff00'"


def test_micrometres_are_asked_about(tmp_path: Path) -> None:
    """Taken as millimetres, a ball of 60 mm is 60 m large."""
    file = _file(tmp_path / "ball.stl", ball(30_000.0).export(file_type="stl"))
    asked = "it is 6e+04 mm large, more than a hand holds: is `unit` right?"
    assert asked in object_mesh(Mesh(file=file)).findings
    assert object_mesh(Mesh(file=file, scale=1e-6, unit="m")).findings == ()
