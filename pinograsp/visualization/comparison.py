"""Tables of the panel besides a grasp's figures: the best that differ, criteria, distances pair by pair."""

from __future__ import annotations

from html import escape

from ..results.configuration_check import ConfigurationCheck
from ..results.criteria import CRITERIA, numbers_of
from ..results.grasp import Grasp
from ..results.html import clearance_cells, columns, grasp_rows
from ..results.ranking import SCORE
from ..results.result import Result


def grasp_list(result: Result, by: str = SCORE, most: int = 10) -> str:
    """Return the table of the best grasps that differ from each other, with their numbers in the result.

    Args:
        result: with a grasp or more.
        by: the order in which they are chosen, as for `Result.ranked`.
        most: number of grasps at most.

    Raises:
        InputError: there is no such criterion or figure.
    """
    headings = "".join(f"<th>{escape(c.heading)}<small>{escape(c.shown_unit)}</small></th>" for c in columns())
    shown = grasp_rows(result, by, most)
    rows = ["<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>" for cells in shown]
    order = "" if by == SCORE else f" by {by}"
    caption = f"{len(shown)} different of {len(result.grasps)} distinct grasps{order}; the first is drawn"
    return (
        f'<table class="list"><caption>{escape(caption)}</caption>'
        f"<tr><th></th><th>found</th>{headings}</tr>{''.join(rows)}</table>"
    )


def criteria_table(grasp: Grasp) -> str:
    """Return the table of what a grasp is compared by, besides U."""
    read = numbers_of(grasp)
    rows = []
    for criterion in CRITERIA:
        if criterion.name != "U":
            name = f"{escape(criterion.name)}<small>{escape(criterion.meaning)}</small>"
            rows.append(f"<tr><td>{name}</td><td>{escape(criterion.shown(read))}</td></tr>")
    return f"<table><caption>Compared by</caption>{''.join(rows)}</table>"


def clearance_table(check: ConfigurationCheck, most: int = 10) -> str:
    """Return the table of the least distances of a checked configuration, at most so many of them."""
    rows = []
    for name, link, other, distance in map(clearance_cells, check.clearances[:most]):
        pair = f"{escape(name)}<small>{escape(link)} - {escape(other)}</small>"
        rows.append(f"<tr><td>{pair}</td><td>{escape(distance)}</td></tr>")
    more = f", the least {most} of {len(check.clearances)}" if len(check.clearances) > most else ""
    return f"<table><caption>Distances below 50 mm{more}</caption>{''.join(rows)}</table>"
