"""Structured mutations of trees of data, XML documents and bytes, from a generator of random numbers."""

from __future__ import annotations

import copy
import random
import xml.etree.ElementTree as ET
from typing import Any

NUMBERS = [0, -0.0, 1, -1, 3, 90, 1e-300, 1e-12, 1e9, 1e16, 1e308, -1e308, 5e-324, 2**53, 2**64, 10**90, float("nan")]
NUMBERS += [float("inf"), float("-inf")]
TEXTS = ["", " ", "a\0b", "x" * 300, "../../x", "/etc/hostname", "/dev/null", "no", "1e3", "12:30", "\u202e", "~", "<<"]
TEXTS += [
    'a", (SELECT 1) AS "b',
    "'; DROP TABLE configurations; --",
    "package://x/../../y.stl",
    "\ud7ff",
    "a.b[0]",
    "$x",
]
OTHERS: list[Any] = [None, True, False, [], {}, [[]], [0.0], [0.0] * 3, [0.0] * 4, {"type": "sphere", "radius": 0.03}]
WORDS = ["nan", "inf", "", "1 2", "1 2 3 4", "1e400", "0 0 0", "-1", "x", "1e-300", "nan 0 0", "1e16 0 0"]
MESH_WORDS = [b"nan", b"inf", b"1e300", b"-1", b"99", b"", b"1.5", b"x", b"1e-300", b"\n"]
Tree = Any
Path = tuple[Any, ...]


def paths(tree: Tree) -> list[Path]:
    """Return the path of everything in a tree of dicts and lists, however deep."""
    found: list[Path] = []
    waiting: list[tuple[Path, Tree]] = [((), tree)]
    while waiting:
        path, block = waiting.pop()
        for key, part in block.items() if isinstance(block, dict) else enumerate(block):
            found.append((*path, key))
            if isinstance(part, dict | list):
                waiting.append((found[-1], part))
    return found


def part_at(tree: Tree, path: Path) -> Any:
    """Return what is at a path."""
    for key in path:
        tree = tree[key]
    return tree


def mutate_tree(tree: Tree, rng: random.Random) -> None:
    """Change one to three things in a tree of dicts and lists."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        places = paths(tree)
        if not places:
            return
        path = rng.choice(places)
        block, key, part = part_at(tree, path[:-1]), path[-1], part_at(tree, path)
        match rng.randrange(9):
            case 0:
                del block[key]
            case 1 if isinstance(block, dict):
                block[rng.choice([*TEXTS, "more", str(key) + "s"])] = block.pop(key)
            case 2 if isinstance(block, dict):
                block[rng.choice([*TEXTS, "more"])] = part
            case 3 if isinstance(block, list):
                block.insert(rng.randrange(len(block) + 1), part)
            case 4:
                block[key] = copy.deepcopy(part_at(tree, rng.choice(places))) if rng.random() < 0.7 else [[part]]
            case 5 if isinstance(part, int | float) and not isinstance(part, bool):
                block[key] = part * rng.choice((0.99, 1.01, -1, 0, 1e3, 1e-3, 57.3)) + rng.choice((0, 0, 1e-3, 1))
            case 6 | 7:
                block[key] = copy.deepcopy(rng.choice(alike(part)))  # one that is changed later is no other's
            case _:
                block[key] = copy.deepcopy(rng.choice([*NUMBERS, *TEXTS, *OTHERS]))


def alike(part: Any) -> list[Any]:
    """Return values of the kind of one."""
    if isinstance(part, bool):
        return [not part]
    if isinstance(part, int | float):
        return NUMBERS
    if isinstance(part, str):
        return TEXTS
    return OTHERS


def mutate_xml(document: ET.Element, rng: random.Random) -> None:
    """Change one to three things in an XML document."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        parents = {child: parent for parent in document.iter() for child in parent}
        element = rng.choice(list(document.iter()))
        match rng.randrange(7):
            case 0 if element in parents:
                parents[element].remove(element)
            case 1 if element in parents:
                parents[element].insert(rng.randrange(len(parents[element]) + 1), element)
            case 2:
                element.tag = rng.choice(["link", "joint", "mimic", "limit", "mesh", "capsule", "x"])
            case 3 if element.attrib:
                del element.attrib[rng.choice(list(element.attrib))]
            case 4 if element.attrib:
                others = [value for other in document.iter() for value in other.attrib.values()]
                element.attrib[rng.choice(list(element.attrib))] = rng.choice(others)
            case _ if element.attrib:
                element.attrib[rng.choice(list(element.attrib))] = rng.choice(
                    [*WORDS, *(t for t in TEXTS if "\0" not in t)]
                )


def mutate_bytes(content: bytes, rng: random.Random) -> bytes:
    """Change one thing in a file, whatever is in it."""
    data = bytearray(content)
    begin = rng.randrange(len(data) + 1)
    end = min(len(data), begin + rng.choice((1, 4, 100, 10_000)))
    match rng.randrange(6):
        case 0:
            del data[begin:]
        case 1:
            del data[begin:end]
        case 2:
            data[begin:begin] = data[begin:end] * rng.choice((1, 10))
        case 3:
            data[begin:end] = rng.randbytes(end - begin)
        case 4:
            data[begin:begin] = rng.choice(
                (b"[" * 3000, b"\0", b"&a ", b"*a", b"nan", b"1e999", b"9" * 5000, b"\xff\xfe")
            )
        case _ if begin < len(data):
            data[begin] ^= 1 << rng.randrange(8)
    return bytes(data)


def mutate_mesh(content: bytes, rng: random.Random) -> bytes:
    """Change a word of a mesh file, if it is a text, or bytes, or both."""
    if rng.random() < 0.5 and b"\0" not in content:
        words = content.split(b" ")
        words[rng.randrange(len(words))] = rng.choice(MESH_WORDS)
        content = b" ".join(words)
    return mutate_bytes(content, rng) if rng.random() < 0.6 else content
