"""Tables as notebooks show them: HTML without colours of its own, so that it reads on light and dark pages."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

_CELL = ' style="text-align: left; vertical-align: top"'


def table(caption: str, rows: Iterable[str], headings: Sequence[str] = ()) -> str:
    """Return a table.

    Args:
        caption: above it, plain text.
        rows: from `row`.
        headings: of the columns, plain text; none: no line of headings.
    """
    head = f"<tr>{''.join(f'<th{_CELL}>{escape(heading)}</th>' for heading in headings)}</tr>" if headings else ""
    title = f'<caption style="text-align: left; color: inherit"><b>{escape(caption)}</b></caption>'
    return f"<table>{title}{head}{''.join(rows)}</table>"


def row(cells: Iterable[str], *, bold: bool = False) -> str:
    """Return a row of a table from plain text, in bold type if it is to stand out."""
    begin, end = ("<b>", "</b>") if bold else ("", "")
    return f"<tr>{''.join(f'<td{_CELL}>{begin}{escape(cell)}{end}</td>' for cell in cells)}</tr>"


def folded(summary: str, content: str) -> str:
    """Return HTML that unfolds below a line of plain text."""
    return f"<details><summary>{escape(summary)}</summary>{content}</details>"
