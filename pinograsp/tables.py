"""Tables in the terminal: one look for all of them, and no number cut, however narrow the terminal."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

GAP = 2
"""Spaces between two columns."""
NARROWEST = 12
"""Columns of words get at least so many characters."""
COLORS = {"red": 31, "green": 32, "yellow": 33}
"""Codes of terminals."""


@dataclass(frozen=True)
class Column:
    """One column."""

    heading: str
    """In one line or several."""
    kind: Literal["number", "lines", "words"]
    """Numbers are to the right; lines to the left; neither is ever wrapped. Words are, where there is little room."""


@dataclass
class Table:
    """Rows of cells below headings.

    Args:
        title: above them; empty: none.
        headings: whether columns have any.
    """

    title: str = ""
    headings: bool = True
    columns: list[Column] = field(default_factory=list)
    rows: list[tuple[str, ...]] = field(default_factory=list)
    colors: list[str] = field(default_factory=list)
    """Of the first cell of each row; empty: none."""

    def numbers(self, *headings: str) -> None:
        """Add columns of numbers."""
        self.columns += [Column(heading, "number") for heading in headings]

    def lines(self, heading: str) -> None:
        """Add a column whose cells are wrapped already."""
        self.columns.append(Column(heading, "lines"))

    def words(self, *headings: str) -> None:
        """Add columns of words."""
        self.columns += [Column(heading, "words") for heading in headings]

    def add(self, *cells: str, color: str = "") -> None:
        """Add a row; a cell may have several lines."""
        self.rows.append(cells)
        self.colors.append(color)

    def drawn(self, width: int, *, color: bool = False) -> str:
        """Return the table as text.

        Args:
            width: of the terminal, in characters; a table that needs more for its numbers is wider.
            color: whether colors are written, as the codes of terminals.
        """
        widths = self._widths(width)
        lines = _wrapped(self.title, max(width, sum(widths))) if self.title else []
        if self.headings:
            lines += self._row([column.heading for column in self.columns], widths)
            lines.append("─" * (sum(widths) + GAP * (len(widths) - 1)))
        for cells, hue in zip(self.rows, self.colors, strict=True):
            lines += self._row(cells, widths, COLORS[hue] if color and hue else None)
        return "\n".join(lines)

    def _widths(self, width: int) -> list[int]:
        """Return the widths of the columns: those of words share the room that the others leave.

        Those that would break inside a word give way last.
        """
        cells = zip(*([[column.heading for column in self.columns]] if self.headings else []), *self.rows, strict=True)
        filled = list(cells)
        widths = [max(len(line) for cell in column for line in cell.split("\n")) for column in filled]
        longest = [max(map(len, re.findall(r"[^_\s]+_?|_", " ".join(column))), default=0) for column in filled]
        room = width - GAP * (len(widths) - 1)
        while sum(widths) > room:
            words = [i for i, column in enumerate(self.columns) if column.kind == "words" and widths[i] > NARROWEST]
            if not words:
                break
            widths[max(words, key=lambda i: (widths[i] > longest[i], widths[i]))] -= 1
        return widths

    def _row(self, cells: tuple[str, ...] | list[str], widths: list[int], code: int | None = None) -> list[str]:
        """Return the lines of a row; the first cell in the color of a code."""
        columns = []
        for column, cell, width in zip(self.columns, cells, widths, strict=True):
            lines = _wrapped(cell, width) if column.kind == "words" else cell.split("\n")
            columns.append([f"{line:>{width}}" if column.kind == "number" else f"{line:<{width}}" for line in lines])
        found = []
        for parts in itertools.zip_longest(*columns):
            filled = [" " * width if part is None else part for part, width in zip(parts, widths, strict=True)]
            if code is not None:
                filled[0] = f"\x1b[{code}m{filled[0]}\x1b[0m"
            found.append((" " * GAP).join(filled).rstrip())
        return found


def _wrapped(text: str, width: int) -> list[str]:
    """Return text in lines: broken at spaces, names that are too long after underscores, else anywhere."""
    lines = []
    for paragraph in text.split("\n"):
        line = ""
        for piece in _pieces(paragraph, width):
            if len((line + piece).rstrip()) > width:
                lines.append(line.rstrip())
                line = ""
            line += piece
        lines.append(line.rstrip())
    return lines


def _pieces(text: str, width: int) -> Iterator[str]:
    """Yield the pieces that lines are made of, none of them wider than a line."""
    for word in re.findall(r"\s*\S+\s*", text):
        if len(word.strip()) <= width:
            yield word
        else:
            for part in re.findall(r"[^_]*_|[^_]+", word):
                yield from (part[i : i + width] for i in range(0, len(part), width))
