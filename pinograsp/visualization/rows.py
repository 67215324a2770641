"""Rows of the tables in a page's panel; the page's style sheet says how they look."""

from __future__ import annotations

from html import escape


def row(name: str, *cells: str, note: str = "", style: str = "") -> str:
    """Return a row, from plain text.

    Args:
        name: the first cell.
        cells: the others.
        note: small print below the name.
        style: class of the row in the style sheet.
    """
    below = f"<small>{escape(note)}</small>" if note else ""
    others = "".join(f"<td>{escape(cell)}</td>" for cell in cells)
    begin = f'<tr class="{style}">' if style else "<tr>"
    return f"{begin}<td>{escape(name)}{below}</td>{others}</tr>"
