"""Results, grasps and checks as notebooks show them; pages take the cells of their tables from here, too."""

from __future__ import annotations

from .. import notebook
from ..units import shown
from ..verification.certificate import PairClearance
from .configuration_check import ConfigurationCheck
from .criteria import CRITERIA, Criterion, numbers_of
from .grasp import Contact, Grasp
from .ranking import SCORE
from .result import ALTERED, Result
from .table import outcome_lines


def columns() -> list[Criterion]:
    """Return the criteria that have a column in lists of grasps."""
    return [criterion for criterion in CRITERIA if criterion.heading]


def result_html(result: Result) -> str:
    """Return a result: the best grasps that differ, and how the starts ended."""
    caption = f"{result.setup}: {result.verified} of {result.done} starts verified"
    if result.altered:
        caption += f"; {ALTERED}"
    headings = ["", "found", *(f"{criterion.heading} {criterion.shown_unit}".strip() for criterion in columns())]
    rows = [notebook.row(cells) for cells in grasp_rows(result)]
    listed = notebook.table(caption, rows, headings)
    lines = [*(f"warning: {warning}" for warning in result.warnings), *outcome_lines(result)]
    return listed + notebook.table("Starts", [notebook.row([line]) for line in lines])


def grasp_rows(result: Result, by: str = SCORE) -> list[list[str]]:
    """Return the best grasps that differ from each other as cells: number in the result, starts, and `columns`.

    Args:
        result: with any number of grasps.
        by: the order in which they are chosen, as for `Result.ranked`.

    Raises:
        InputError: there is no such criterion or figure.
    """
    return [
        [str(result.number_of(grasp)), f"{starts}x", *(criterion.cell(numbers_of(grasp)) for criterion in columns())]
        for grasp, starts, _ in result.different(by=by)
    ]


def grasp_html(grasp: Grasp) -> str:
    """Return a grasp: what it is compared by, joints, contacts, and the figures of its certificate."""
    place = f" of {grasp.setup}" if grasp.setup else ""
    verdict = "verified" if grasp.certificate.verified else "not verified"
    numbers = numbers_of(grasp)
    rows = [notebook.row((criterion.name, criterion.shown(numbers), criterion.meaning)) for criterion in CRITERIA]
    details = (
        notebook.table("Joints, rad (m)", [notebook.row((name, f"{q:.4f}")) for name, q in grasp.joints.items()])
        + notebook.table("Contacts", map(_contact_row, grasp.contacts), ("pad", "link", "force"))
        + grasp.certificate._repr_html_()
    )
    return notebook.table(f"Grasp{place}: {verdict}", rows) + notebook.folded("joints, contacts, certificate", details)


def check_html(check: ConfigurationCheck) -> str:
    """Return a check: its warnings, the certificate, and the distances pair by pair."""
    odd = notebook.table("Warnings", [notebook.row([line]) for line in check.warnings]) if check.warnings else ""
    nearest = [notebook.row(cells) for cells in map(clearance_cells, check.clearances)]
    clearances = notebook.table("Distances below 50 mm", nearest, ("kind", "link", "other", "distance"))
    return (
        odd + check.certificate._repr_html_() + notebook.folded(f"{len(nearest)} pairs nearer than 50 mm", clearances)
    )


def clearance_cells(pair: PairClearance) -> tuple[str, str, str, str]:
    """Return the cells of a distance; -inf is that of two that intersect to an unknown depth."""
    return pair.name, pair.link, pair.other, shown(pair.distance, "m", "z.1f")


def _contact_row(contact: Contact) -> str:
    force = ", ".join(f"{component:z.2f}" for component in contact.force)
    return notebook.row((contact.pad, contact.link, f"({force}) N"))
