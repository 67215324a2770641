"""What is wrong with a mesh file that its parser refuses, in plain words: parsers speak of their own insides.

Nothing here is asked of a file that can be read.
"""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from ..errors import FileError
from .ply_header import PlyFile, ply_file

SHOWN = 40
"""Characters of a line that are quoted at most."""
_GLB_HEADER, _CHUNK = 12, 8
_COMPONENTS: dict[object, int] = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
"""Bytes of a number of glTF's component types."""
_NUMBERS: dict[object, int] = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
"""Numbers of an entry of glTF's types."""


def damage(content: bytes, kind: str) -> str | None:
    """Return what is wrong with the content of a mesh file; None: nothing is found.

    Args:
        content: of the file.
        kind: its suffix without the point, in lower case.
    """
    look = _LOOKS.get(kind)
    try:
        return None if look is None else look(content)
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError):  # parts are no such parts
        return None


def unreadable(content: bytes, file: Path) -> FileError:
    """Return the error about a mesh file that its parser refuses.

    Args:
        content: of the file.
        file: its suffix tells the format.
    """
    kind = file.suffix[1:].lower()
    why = damage(content, kind) or "it is damaged, or uses a part of the format that is not read"
    remedy = "Is it a whole file, and of the kind that its suffix says?"
    return FileError(f"cannot be read as {kind.upper()}: {why}", file=file, remedy=remedy)


def quoted(text: str) -> str:
    """Return a line in quotation marks, the beginning of a long one."""
    return repr(text if len(text) <= SHOWN else text[:SHOWN] + " ...")


def are_numbers(words: Sequence[str], count: int, number: Callable[[str], object] = float) -> bool:
    """Return whether the first `count` words are there and are numbers."""
    try:
        return len([number(word) for word in words[:count]]) == count
    except (ValueError, OverflowError):
        return False


def off_rows(content: bytes) -> list[str] | None:
    """Return the lines of an OFF file that say something, the numbers of corners and faces first; None: it is none."""
    lines = [line.partition("#")[0].strip() for line in content.decode("utf-8", "replace").splitlines()]
    lines = [line for line in lines if line]
    first = re.fullmatch(r"(?:COFF|OFF)\s*(.*)", lines[0]) if lines else None
    if first is None:
        return None
    return [first[1], *lines[1:]] if first[1] else lines[1:]


def _of_off(content: bytes) -> str | None:
    rows = off_rows(content)
    if rows is None:
        return "it does not begin with OFF"
    if not rows or not are_numbers(rows[0].split(), 2, np.int64):
        told = quoted(rows[0]) if rows else "nothing"
        return f"the numbers of its corners and faces should follow OFF, and {told} does"
    corners, faces = (int(word) for word in rows[0].split()[:2])
    for number, row in enumerate(rows[1 : corners + 1]):
        if not are_numbers(row.split(), 3):
            return f"corner {number}, counted from 0, is not three numbers: {quoted(row)}"
    for number, row in enumerate(rows[corners + 1 : corners + faces + 1]):
        words, of = row.split(), f"face {number}, counted from 0,"
        if (
            not are_numbers(words, 1, np.int64)
            or int(words[0]) < 3
            or not are_numbers(words[1:], int(words[0]), np.int64)
        ):
            return f"{of} is no number of corners and so many corners: {quoted(row)}"
        for word in words[1 : int(words[0]) + 1]:
            if not 0 <= int(word) < corners:
                return f"{of} has the corner {int(word)}, of {corners}"
    return None


def _of_dae(content: bytes) -> str | None:
    try:
        root = ET.fromstring(content)
    except ET.ParseError as error:
        line, column = error.position
        return f"it is XML that ends or breaks in line {line}, column {column + 1}"
    if root.tag.rpartition("}")[2] != "COLLADA":
        return f"it is XML of another kind: <{root.tag.rpartition('}')[2]}>, not <COLLADA>"
    defined = {element.get("id") for element in root.iter()}
    for element in root.iter():
        for key in ("source", "url", "target"):
            address = element.get(key, "")
            if address.startswith("#") and address[1:] not in defined:
                return f"it refers to {quoted(address)}, which it does not define"
    for array in root.iter():
        words = (array.text or "").split() if array.tag.endswith("float_array") else []
        if words and (len(words) != int(array.get("count", "0")) or not are_numbers(words, len(words))):
            return f"{quoted(str(array.get('id')))} is not as many numbers as it says"
    return None


def _of_ply(content: bytes) -> str | None:
    if content.lstrip()[:3].lower() != b"ply":
        return "it does not begin with ply"
    found = ply_file(content)
    if found is None:
        return "its header has a line that is not understood, or no end_header"
    vertex = next((element for element in found.elements if element.name == "vertex"), None)
    if vertex is None:
        return "its header tells of no vertex"
    if missing := [name for name in "xyz" if name not in vertex.names]:
        return f"its vertices have no {' and no '.join(missing)}"
    return _of_ply_text(found) if found.is_text else _of_ply_bytes(found)


def _of_ply_text(found: PlyFile) -> str | None:
    for element, number, row in found.rows():
        words, of = row.split(), f"{element.name} {number}, counted from 0,"
        if not are_numbers(words, len(words)):
            return f"{of} is not numbers alone: {quoted(row)}"
        if not words or len(words) != element.words(words):
            return f"{of} has other numbers than the header announces: {quoted(row)}"
    return None


def _of_ply_bytes(found: PlyFile) -> str | None:
    there = len(found.body)
    try:
        wanted = max((int(starts[-1]) for starts in found.starts.values()), default=0)
    except ValueError:
        return f"it is cut off: {there} bytes follow its header, which announces more"
    if wanted != there:
        cut = "it is cut off: " if there < wanted else ""
        return f"{cut}{there} bytes follow its header, which announces {wanted}"
    if any(len(np.unique(np.diff(starts))) > 1 for starts in found.starts.values()):
        return "its faces have different numbers of corners; write it as text (ascii), or with triangles alone"
    return None


def _of_glb(content: bytes) -> str | None:
    if content[:4] != b"glTF":
        return "it does not begin with glTF"
    told = int.from_bytes(content[8:12], "little")
    if len(content) < max(told, _GLB_HEADER + _CHUNK):
        return f"it is cut off: {len(content)} of {told} bytes are there"
    size = int.from_bytes(content[12:16], "little")
    text = content[_GLB_HEADER + _CHUNK : _GLB_HEADER + _CHUNK + size]
    try:
        tree = json.loads(text)
    except UnicodeDecodeError as error:
        return f"its JSON part is damaged at byte {error.start} of {len(text)}"
    except json.JSONDecodeError as error:
        return f"its JSON part is damaged at character {error.pos} of {len(error.doc)}"
    except RecursionError:
        return "its JSON part has lists within lists without end"
    if not isinstance(tree, dict):
        return "its JSON part is no table of keys"
    if extensions := tree.get("extensionsRequired"):
        return f"it needs the extension {', '.join(map(str, extensions))}; write it without"
    data = max(0, len(content) - (_GLB_HEADER + _CHUNK + size + _CHUNK))
    return _of_gltf(tree, data)


def _of_gltf(tree: dict[str, list[dict[str, object]]], data: int) -> str | None:
    """Return which reference of a glTF tree leads nowhere, or beyond so many bytes of data."""
    accessors, views, meshes = (tree.get(name, []) for name in ("accessors", "bufferViews", "meshes"))
    for number, mesh in enumerate(meshes):
        for primitive in mesh["primitives"]:  # type: ignore[attr-defined]
            used = {**primitive.get("attributes", {}), "indices": primitive.get("indices", 0)}
            if "POSITION" not in used:
                return f"mesh {number} has no places of corners (POSITION)"
            for name, index in used.items():
                if not 0 <= index < len(accessors):
                    return f"{name} of mesh {number} is accessor {index}, of {len(accessors)}"
    for number, accessor in enumerate(accessors):
        if not 0 <= int(str(accessor.get("bufferView", 0))) < len(views):
            return f"accessor {number} is in bufferView {accessor['bufferView']}, of {len(views)}"
        size = _COMPONENTS.get(accessor.get("componentType"), 0) * _NUMBERS.get(accessor.get("type"), 0)
        if not size:
            return f"accessor {number} has numbers of an unknown type"
        room = int(str(views[int(str(accessor.get("bufferView", 0)))]["byteLength"]))
        if int(str(accessor["count"])) * size > room:
            return f"accessor {number} has {accessor['count']} entries, of {size} bytes, in {room} bytes"
    for number, view in enumerate(views):
        end = int(str(view.get("byteOffset", 0))) + int(str(view["byteLength"]))
        if end > data:
            return f"bufferView {number} ends at byte {end} of {data}"
    for number, node in enumerate(tree.get("nodes", [])):
        if not 0 <= int(str(node.get("mesh", 0))) < max(1, len(meshes)):
            return f"node {number} has mesh {node['mesh']}, of {len(meshes)}"
    return None


def _of_stl(content: bytes) -> str | None:
    for number, line in enumerate(content.decode("utf-8", "replace").splitlines(), 1):
        words = line.split()
        if words[:1] == ["vertex"] and (len(words) != 4 or not are_numbers(words[1:], 3)):
            return f"line {number} is not a corner of three numbers: {quoted(line.strip())}"
    return None


_LOOKS: dict[str, Callable[[bytes], str | None]] = {
    "off": _of_off,
    "dae": _of_dae,
    "ply": _of_ply,
    "glb": _of_glb,
    "stl": _of_stl,
}
