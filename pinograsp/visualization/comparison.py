"""Tables of the panel besides a grasp's figures: the best that differ, criteria, distances pair by pair."""

from __future__ import annotations

from html import escape

from ..results.configuration_check import ConfigurationCheck
from ..results.criteria import CRITERIA, numbers_of
from ..results.explanation import Explanation
from ..results.grasp import Grasp
from ..results.html import clearance_cells, columns, grasp_rows
from ..results.ranking import SCORE
from ..results.result import Result
from ..units import shown
from .rows import row

DISTANCES = 10
"""Distances that a page lists."""


def grasp_list(result: Result, by: str = SCORE) -> str:
    """Return the table of the best grasps that differ from each other, with their numbers in the result.

    Args:
        result: with a grasp or more.
        by: the order in which they are chosen, as for `Result.ranked`.

    Raises:
        InputError: there is no such criterion or figure.
    """
    headings = "".join(f"<th>{escape(c.heading)}<small>{escape(c.shown_unit)}</small></th>" for c in columns())
    shown = grasp_rows(result, by)
    order = "" if by == SCORE else f" by {by}"
    caption = f"{len(shown)} different of {len(result.grasps)} distinct grasps{order}; the first is drawn"
    return (
        f'<table class="list"><caption>{escape(caption)}</caption>'
        f"<tr><th></th><th>found</th>{headings}</tr>{''.join(row(*cells) for cells in shown)}</table>"
    )


def criteria_table(grasp: Grasp) -> str:
    """Return the table of what a grasp is compared by, besides U."""
    read = numbers_of(grasp)
    rows = [row(c.name, c.shown(read), note=c.meaning) for c in CRITERIA if c.name != "U"]
    return f"<table><caption>Compared by</caption>{''.join(rows)}</table>"


def explanation_tables(explanation: Explanation) -> str:
    """Return the tables of causes and remedies."""
    causes = [
        row(cause.kind, f"{100.0 * cause.share:.0f} %", shown(cause.nearest_miss, cause.unit), note=cause.where)
        for cause in explanation.causes
    ]
    remedies = [row(r.text, f"{r.verified} of {r.tried}", note="starts verified then") for r in explanation.remedies]
    tried = [row(t.text, t.ending) for t in explanation.tried]
    kept, helps = "What kept starts from a grasp, nearest miss", "What would help"
    tables = ((kept, causes), (helps, remedies), ("What was tried besides", tried))
    return "".join(f"<table><caption>{name}</caption>{''.join(rows)}</table>" for name, rows in tables if rows)


def clearance_table(check: ConfigurationCheck) -> str:
    """Return the table of the least distances of a checked configuration, at most `DISTANCES` of them."""
    listed = map(clearance_cells, check.clearances[:DISTANCES])
    rows = [row(name, distance, note=f"{link} - {other}") for name, link, other, distance in listed]
    more = f", the least {DISTANCES} of {len(check.clearances)}" if len(check.clearances) > DISTANCES else ""
    return f"<table><caption>Distances below 50 mm{more}</caption>{''.join(rows)}</table>"
