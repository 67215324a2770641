"""Tables of the panel that compare grasps: the list of the best that differ, and the criteria of one grasp."""

from __future__ import annotations

from html import escape

from ..results.criteria import CRITERIA, numbers_of
from ..results.grasp import Grasp
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
    columns = [criterion for criterion in CRITERIA if criterion.heading]
    numbers = {id(grasp): number for number, grasp in enumerate(result.grasps, 1)}
    shown = result.different(most, by)
    headings = "".join(f"<th>{escape(c.heading)}<small>{escape(c.shown_unit)}</small></th>" for c in columns)
    rows = []
    for grasp, starts, _ in shown:
        read = numbers_of(grasp)
        cells = (str(numbers[id(grasp)]), f"{starts}x", *(criterion.cell(read) for criterion in columns))
        rows.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>")
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
            value = criterion.cell(read)
            shown = value if value == "-" else f"{value} {criterion.shown_unit}"
            name = f"{escape(criterion.name)}<small>{escape(criterion.meaning)}</small>"
            rows.append(f"<tr><td>{name}</td><td>{escape(shown)}</td></tr>")
    return f"<table><caption>Compared by</caption>{''.join(rows)}</table>"
