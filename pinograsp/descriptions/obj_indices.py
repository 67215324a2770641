"""Indices of OBJ files that count back from the last vertex, written as those that count from the first.

Trimesh counts such indices back from the last vertex of the file, where they are meant from the face on upwards.
"""

from __future__ import annotations

import re

_BACK = re.compile(rb"^\s*f\s[^\n]*-", re.MULTILINE)
_KINDS = (b"v", b"vt", b"vn")


def counted_from_first(content: bytes, kind: str) -> bytes:
    """Return the content of a mesh file; of an OBJ file with indices that count back, with those that do not.

    Args:
        content: of the file.
        kind: its suffix without the point, in lower case.

    Raises:
        ValueError: an index is no number, or counts back beyond the first.
    """
    if kind != "obj" or not _BACK.search(content):
        return content
    counts = dict.fromkeys(_KINDS, 0)
    lines = content.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines()
    for index, line in enumerate(lines):
        words = line.split() or [b""]
        if words[0] in counts:
            counts[words[0]] += 1
        elif words[0] == b"f":
            lines[index] = b" ".join([b"f", *(_corner(word, [counts[kind] for kind in _KINDS]) for word in words[1:])])
    return b"\n".join(lines) + b"\n"


def _corner(word: bytes, counts: list[int]) -> bytes:
    """Return a corner such as -1/-1/-1, its numbers counted from the first of so many."""
    return b"/".join(_number(text, count) for text, count in zip(word.split(b"/"), counts, strict=False))


def _number(text: bytes, count: int) -> bytes:
    if not text.startswith(b"-"):
        return text
    if int(text) < -count:
        raise ValueError(f"a face has the vertex {int(text)}, of {count}")
    return b"%d" % (int(text) + count + 1)
