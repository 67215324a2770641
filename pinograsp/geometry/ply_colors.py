"""Colours of PLY files: all three of them, and in their range; parsers make others of what is beyond it."""

from __future__ import annotations

import numpy as np

from ..descriptions.ply_header import Element, PlyFile, ply_file
from ..errors import FileError

COLORS = ("red", "green", "blue")
_COLORS_OF = {True: "Colours of type float", False: "Colours in whole numbers"}
_REMEDY = "Export it again, with red, green and blue or without colours"


def require_colors(content: bytes) -> None:
    """Refuse a PLY file of which an element has some of the three colours only, or a colour beyond its range.

    Whole numbers go from 0 to 255, others from 0 to 1. A file that its parser will refuse is left to it.
    """
    found = ply_file(content)
    for element in () if found is None else found.elements:
        missing = sorted(set(COLORS) - set(element.names))
        if missing and len(missing) < len(COLORS):
            problem = f"has colours without {' and '.join(missing)} in its element {element.name}"
            raise FileError(problem, remedy=_REMEDY)
        if found is not None and not missing:
            _require_range(found, element)


def _require_range(found: PlyFile, element: Element) -> None:
    for name in COLORS:
        kind = next(each.type for each in element.properties if each.name == name)
        if not found.is_text and kind == np.uint8:
            continue
        try:
            values = found.column(element, name)
        except (ValueError, LookupError, OverflowError):  # its parser refuses it
            return
        most = 1 if kind.kind == "f" else 255
        beyond = np.flatnonzero(~((values >= 0) & (values <= most)))
        if len(beyond):
            first = int(beyond[0])
            problem = f"has the colour {name} {values[first]:g} at {element.name} {first}, counted from 0"
            raise FileError(problem, remedy=f"{_COLORS_OF[kind.kind == 'f']} go from 0 to {most}; export it again")
