"""What a PLY file announces in its header, and the numbers of its rows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np

from ..arrays import Array, Integers

_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
    "int64": "i8",
    "uint64": "u8",
    "float16": "f2",
}
"""NumPy's types by their names in PLY files."""
_DIGITS = 15
"""Of a number of rows; none has more."""


@dataclass(frozen=True)
class Property:
    """A number, or a list of numbers, in each row of an element."""

    name: str
    type: np.dtype[np.generic]
    """Of a number."""
    counted: np.dtype[np.generic] | None
    """Type of what stands before a list: how many numbers it has; None: it is one number."""


@dataclass(frozen=True)
class Element:
    """Rows that have the same properties."""

    name: str
    count: int
    """Number of rows."""
    properties: tuple[Property, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the properties."""
        return tuple(each.name for each in self.properties)

    def words(self, row: Sequence[str], before: str | None = None) -> int:
        """Return how many words a row of text has, or how many before a property."""
        place = 0
        for each in self.properties:
            if each.name == before:
                break
            place += 1 if each.counted is None else 1 + int(float(row[place]))
        return place

    def size(self, body: bytes, start: int, before: str | None = None) -> int:
        """Return how many bytes a row has that starts at a byte of the body, or how many before a property."""
        place = start
        for each in self.properties:
            if each.name == before:
                break
            if each.counted is None:
                place += each.type.itemsize
            else:
                count = np.frombuffer(body, each.counted, 1, place)[0]
                place += each.counted.itemsize + int(count) * each.type.itemsize
        return place - start


@dataclass(frozen=True)
class PlyFile:
    """A PLY file: its header, and the rows that follow."""

    is_text: bool
    elements: tuple[Element, ...]
    body: bytes
    """What follows the header."""

    def rows(self) -> Iterator[tuple[Element, int, str]]:
        """Yield element, number from 0, and text of the rows that are there; of a text file."""
        lines = iter(self.body.decode("utf-8", "replace").splitlines())
        for element in self.elements:
            for number, row in enumerate(islice(lines, element.count)):
                yield element, number, row

    @cached_property
    def starts(self) -> dict[str, Integers]:
        """The byte at which each row of each element starts, in the body of a binary file, and that behind the last.

        Raises:
            ValueError: it ends before.
        """
        starts, place = dict[str, Integers](), 0
        for element in self.elements:
            if element.count > len(self.body):
                raise ValueError("more rows than bytes")
            if all(each.counted is None for each in element.properties):
                size = element.size(self.body, place)
                starts[element.name] = place + size * np.arange(element.count + 1)
                place += size * element.count
            else:
                found = [place]
                for _ in range(element.count):
                    found.append(found[-1] + element.size(self.body, found[-1]))
                starts[element.name], place = np.array(found, dtype=np.int64), found[-1]
        return starts

    def column(self, element: Element, name: str) -> Array:
        """Return the numbers of a property, no list, in the rows of an element, shape (rows,).

        Raises:
            ValueError: the file ends before, or has a word that is no number.
            LookupError: a row is too short.
        """
        if self.is_text:
            rows = (row.split() for each, _, row in self.rows() if each is element)
            return np.array([float(row[element.words(row, name)]) for row in rows])
        kind = next(each.type for each in element.properties if each.name == name)
        places = [int(start) + element.size(self.body, int(start), name) for start in self.starts[element.name][:-1]]
        return np.array([np.frombuffer(self.body, kind, 1, place)[0] for place in places], dtype=np.float64)


def ply_file(content: bytes) -> PlyFile | None:
    """Return what a PLY file announces; None: its header cannot be understood."""
    head, end, rest = content.partition(b"end_header")
    elements, form = list[tuple[str, int, list[Property]]](), ""
    lines = [line.split() for line in head.decode("ascii", "replace").splitlines()[1:]]
    form = next((line[1] for line in lines if line[:1] == ["format"] and len(line) > 1), "")
    order = ">" if form == "binary_big_endian" else "<"
    for line in lines:
        match line:
            case [] | ["format" | "comment" | "obj_info", *_]:
                pass
            case ["element", name, count] if count.isdigit() and len(count) <= _DIGITS:
                elements.append((name, int(count), []))
            case ["property", "list", counted, kind, name] if elements and {counted, kind} <= _TYPES.keys():
                numbers, of_list = (np.dtype(order + _TYPES[each]) for each in (kind, counted))
                elements[-1][2].append(Property(name, numbers, of_list))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1][2].append(Property(name, np.dtype(order + _TYPES[kind]), None))
            case _:
                return None
    if not end or form not in ("ascii", "binary_little_endian", "binary_big_endian"):
        return None
    found = tuple(Element(name, count, tuple(properties)) for name, count, properties in elements)
    return PlyFile(form == "ascii", found, rest.partition(b"\n")[2])
