"""Tables in the terminal: one look for all of them, and no number cut, however narrow the terminal."""

from __future__ import annotations

import io

from rich import box
from rich.console import Console
from rich.measure import Measurement
from rich.table import Column, Table
from rich.text import Text

NARROWEST = 12
"""Columns of words get at least so many characters."""
GAP = 2
"""Characters between two columns."""


def new_table(title: str = "", *, headings: bool = True) -> Table:
    """Return a table without columns.

    Args:
        title: above it, as it is; empty: none.
        headings: whether its columns have headings.
    """
    return Table(
        title=Text(title) if title else None,
        title_justify="left",
        title_style="italic",
        show_header=headings,
        box=box.SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
        show_edge=False,
        pad_edge=False,
    )


def numbers(table: Table, *headings: str) -> None:
    """Add columns of numbers: to the right, never wrapped."""
    for heading in headings:
        table.add_column(heading, justify="right", no_wrap=True)


def words(table: Table, *headings: str) -> None:
    """Add columns of words: wrapped where there is little room, names that are longer in several pieces."""
    for heading in headings:
        table.add_column(heading, overflow="fold")


def drawn(table: Table, width: int, *, color: bool = False) -> str:
    """Return a table as text, its lines without trailing spaces.

    Args:
        table: made by `new_table`; its cells are in Rich's markup.
        width: of the terminal, in characters; a table that needs more for its numbers is wider.
        color: whether styles are written as the terminal's control codes.
    """
    console = Console(file=io.StringIO(), width=10_000, highlight=False)
    least = sum(_least(column, console) for column in table.columns) + GAP * (len(table.columns) - 1)
    console = Console(
        file=io.StringIO(),
        width=max(width, least),
        force_terminal=color,
        color_system="standard" if color else None,
        legacy_windows=False,
        highlight=False,
    )
    with console.capture() as captured:
        console.print(table)
    return "\n".join(line.rstrip() for line in captured.get().splitlines())


def _least(column: Column, console: Console) -> int:
    """Return the width that a column needs, without its padding."""
    cells = [Text.from_markup(str(cell)) for cell in (column.header, *column.cells)]
    widest = max(Measurement.get(console, console.options, cell).maximum for cell in cells)
    return widest if column.no_wrap else min(widest, NARROWEST)
