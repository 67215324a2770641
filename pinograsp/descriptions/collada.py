"""What a COLLADA file says that its parser takes without a word: looked for in its text before it is parsed.

The parser makes 0 of corners that are no numbers, counts indices below 0 from the last corner, takes a unit that is no
number for a metre, and asks for room for as many corners as a polygon says that it has.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

from ..errors import FileError

_VCOUNTS = re.compile(rb"<(?:\w+:)?vcount\b[^>]*>([^<]*)<")
_INDICES = re.compile(rb"<(?:\w+:)?p\b[^>]*>([^<]*)<")
_UNIT = re.compile(rb"<(?:\w+:)?unit\b[^>]*?\bmeter\s*=\s*[\"']([^\"']*)[\"']")
_POSITION = re.compile(
    rb"<(?:\w+:)?input\b(?=[^>]*\bsemantic\s*=\s*[\"']POSITION[\"'])[^>]*\bsource\s*=\s*[\"']#([^\"']+)"
)
_SOURCE = re.compile(
    rb"<(?:\w+:)?source\b[^>]*\bid\s*=\s*[\"']([^\"']+)[\"'][^>]*>(.*?)</(?:\w+:)?source\s*>", re.DOTALL
)
_NUMBERS = re.compile(rb"<(?:\w+:)?float_array\b[^>]*>([^<]*)<")
_NO_NUMBER = re.compile(rb"[+-]?(?:nan|inf)[a-z]*", re.IGNORECASE)
AGAIN = "Export it again"


def require_sound(content: bytes, file: Path) -> None:
    """Refuse a COLLADA file with what its parser would pass over.

    Args:
        content: of the file.
        file: named in errors.

    Raises:
        FileError: a corner is no number, an index is below 0, the unit is no length, or a polygon has more corners than
            the file has room for.
    """
    for counts in _VCOUNTS.findall(content):
        most = max((float(count) for count in re.findall(rb"\d+", counts)), default=0.0)
        if most > len(content):
            problem = f"has a polygon of {most:.3g} corners (<vcount>), in {len(content)} bytes"
            raise FileError(problem, file=file, remedy=AGAIN)
    if unit := _UNIT.search(content):
        text = unit[1].decode("utf-8", "replace")
        if not _is_length(text):
            raise FileError(f"states a unit of {text!r} m", file=file, remedy="Export it again in metres")
    for indices in _INDICES.findall(content):
        if negative := re.search(rb"-\d+", indices):
            problem = f"has the index {negative[0].decode()} among those of its corners (<p>)"
            raise FileError(problem, file=file, remedy=AGAIN)
    positions = set(_POSITION.findall(content))
    for name, source in _SOURCE.findall(content) if positions else ():
        for numbers in _NUMBERS.findall(source) if name in positions else ():
            if none := _NO_NUMBER.search(numbers):
                place = len(numbers[: none.start()].split())
                problem = (
                    f"has the coordinate {none[0].decode()}, number {place + 1} of {name.decode('utf-8', 'replace')}"
                )
                raise FileError(problem, file=file, remedy=AGAIN)


def _is_length(text: str) -> bool:
    try:
        return 0.0 < float(text) < math.inf
    except ValueError:
        return False
