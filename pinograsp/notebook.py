"""Tables as notebooks show them: HTML without colours of its own, so that it reads on light and dark pages."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

_LAST = ' style="text-align: left; vertical-align: top"'
_CELL = ' style="text-align: left; vertical-align: top; white-space: nowrap; padding-right: 1em"'


def table(caption: str, rows: Iterable[str], headings: Sequence[str] = ()) -> str:
    """Return a table.

    Args:
        caption: above it, plain text.
        rows: from `row`.
        headings: of the columns, plain text; none: no line of headings.
    """
    head = f"<tr>{_cells(headings, 'th')}</tr>" if headings else ""
    title = f'<caption style="text-align: left; color: inherit"><b>{escape(caption)}</b></caption>'
    return f"<table>{title}{head}{''.join(rows)}</table>"


def row(cells: Iterable[str], *, bold: bool = False) -> str:
    """Return a row of a table from plain text, in bold type if it is to stand out."""
    return f"<tr>{_cells(tuple(cells), 'td', bold)}</tr>"


def folded(summary: str, content: str) -> str:
    """Return HTML that unfolds below a line of plain text."""
    return f"<details><summary>{escape(summary)}</summary>{content}</details>"


def _cells(texts: Sequence[str], tag: str, bold: bool = False) -> str:
    """Return the cells of a row; only in the last one a line may break, since it holds words and not a number."""
    begin, end = ("<b>", "</b>") if bold else ("", "")
    styles = [_CELL] * (len(texts) - 1) + [_LAST]
    cells = zip(styles, map(escape, texts), strict=True)
    return "".join(f"<{tag}{style}>{begin}{text}{end}</{tag}>" for style, text in cells)
