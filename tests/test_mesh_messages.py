"""Faults of mesh files, told so that they can be mended."""

from __future__ import annotations

from pathlib import Path

import pytest
from meshes import ball

from pinograsp.descriptions.shapes import Mesh
from pinograsp.errors import FileError
from pinograsp.geometry.object_mesh import object_mesh


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


def test_damaged_json_of_a_glb(tmp_path: Path) -> None:
    content = bytearray(ball(0.03).export(file_type="glb"))
    content[20:21] = b"x"
    with pytest.raises(FileError, match=r"ball\.glb: cannot be read as GLB \(its JSON part is damaged at character 0 "):
        object_mesh(Mesh(file=_file(tmp_path / "ball.glb", bytes(content))))


def test_micrometres_are_asked_about(tmp_path: Path) -> None:
    """Taken as millimetres, a ball of 60 mm is 60 m large."""
    file = _file(tmp_path / "ball.stl", ball(30_000.0).export(file_type="stl"))
    asked = "it is 6e+04 mm large, more than a hand holds: is `unit` right?"
    assert asked in object_mesh(Mesh(file=file)).findings
    assert object_mesh(Mesh(file=file, scale=1e-6, unit="m")).findings == ()
