"""Results in the terminal."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from ..tables import GAP, Table
from ..units import shown
from ..verification.certificate import Figure, PairClearance, summary
from .criteria import CRITERIA, criterion_of, numbers_of
from .explanation import Cause, Explanation
from .grasp import Contact, Grasp
from .ranking import SCORE
from .result import Blocked, Result

ANGLE = 5
"""Characters of an angle in whole degrees, with the space before it."""


def grasp_table(result: Result, by: str = SCORE, width: int = 80) -> Table:
    """Return a table of the best grasps that differ from each other.

    Grasps go by their numbers in the result, from 1; `found` counts the starts of all grasps that one stands for.

    Args:
        result: with a grasp or more.
        by: the order in which they are chosen, as for `Result.ranked`.
        width: of the terminal, in characters; angles for which a line has no room follow in the next one.

    Raises:
        InputError: there is no such criterion or figure.
    """
    shown = [(grasp, starts) for grasp, starts, _ in result.different(by=by)]
    title = f"{result.task}: {len(shown)} different of {len(result.grasps)} distinct grasps"
    title += f", {result.robot} in {result.scene}" + ("" if by == SCORE else f", by {by}")
    return list_table(result, shown, title, [by], width)


def list_table(
    result: Result, shown: Sequence[tuple[Grasp, int]], title: str, criteria: Sequence[str] = (), width: int = 80
) -> Table:
    """Return a table of grasps of a result in the order given; they go by their numbers in the result, from 1.

    Args:
        result: that they belong to.
        shown: grasps, each with the number of starts that it stands for.
        title: of the table.
        criteria: names of criteria or figures that get a column besides those that every table has; "score" has none.
        width: of the terminal, in characters.

    Raises:
        InputError: there is no such criterion or figure.
    """
    columns = {criterion.name: criterion for criterion in CRITERIA if criterion.narrow}
    for name in criteria:
        if name != SCORE:
            criterion = criterion_of(name, result.grasps)
            columns.setdefault(criterion.name, criterion)
    headings = ["", "found", *(f"{criterion.heading}\n{criterion.shown_unit}" for criterion in columns.values())]
    rows = [
        [str(result.number_of(grasp)), f"{starts}x", *(c.cell(numbers_of(grasp)) for c in columns.values())]
        for grasp, starts in shown
    ]
    table = Table(title)
    table.numbers(*headings)
    table.lines(" arm joints\n °")
    taken = sum(max(map(_width, column)) + GAP for column in zip(headings, *rows, strict=True))
    for (grasp, _), row in zip(shown, rows, strict=True):
        table.add(*row, angle_lines(grasp.q_arm, width - taken))
    return table


def _width(cell: str) -> int:
    return max(len(line) for line in cell.split("\n"))


def angle_lines(angles: Iterable[float], room: int) -> str:
    """Return angles in whole degrees, in as many lines of equal length as the room in a line makes necessary."""
    cells = [f"{math.degrees(angle):{ANGLE}.0f}" for angle in angles]
    lines = math.ceil(len(cells) / max(1, room // ANGLE))
    length = math.ceil(len(cells) / lines)
    return "\n".join("".join(cells[i : i + length]) for i in range(0, len(cells), length))


def figures_table(figures: Iterable[Figure], title: str = "") -> Table:
    """Return a table of figures of a certificate with their limits; what does not hold has a mark."""
    table = Table(title)
    table.numbers("")
    table.words("figure")
    table.numbers("value", "limit")
    table.words("where")
    for figure in figures:
        cells = ("" if figure.holds else "!", figure.name, figure.shown_value, figure.shown_limit)
        table.add(*cells, figure.where, color="" if figure.holds else "red")
    return table


def clearances_table(clearances: Iterable[PairClearance], title: str = "") -> Table:
    """Return a table of the distances of links to each other and to what stands around them, in mm.

    The kinds of clearances go by their first word, `self` for `self clearance`.
    """
    table = Table(title)
    table.numbers("mm")
    table.words("between", "kind")
    for pair in clearances:
        distance = shown(pair.distance, "m", "z.1f")
        table.add(distance.removesuffix(" mm"), f"{pair.link} / {pair.other}", pair.name.removesuffix(" clearance"))
    return table


def contacts_table(contacts: Iterable[Contact], title: str = "") -> Table:
    """Return a table of contacts: points in mm in the world, forces in N, spin torques in N mm."""
    table = Table(title)
    table.words("pad")
    table.numbers("contact point\nmm", "force on the object\nN", "spin\nN mm")
    for contact in contacts:
        point = "".join(f"{1e3 * x:8.1f}" for x in contact.point)
        force = "".join(f"{x:7.2f}" for x in contact.force)
        table.add(contact.pad, point, force, f"{1e3 * contact.spin_torque:.1f}")
    return table


def outcome_lines(result: Result) -> list[str]:
    """Return what became of the starts, in words."""
    share = f" ({100 * result.verified / result.done:.1f} %)" if result.done else ""
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in result.counts.items() if count)
    lines = [f"{result.verified} of {_starts(result.done)} verified{share}; solver: {outcomes or 'no start'}"]
    if result.setup.scene.task(result.task).desired_contacts is None:
        lines.append("no contacts desired: each start was led to pairs that were proposed to it; Phi is 0, U is k V")
    if result.interrupted and result.done < result.starts:
        lines.append(f"{result.starts - result.done} of {_starts(result.starts)} not tried: interrupted")
    elif result.interrupted:
        lines.append("interrupted: the resistance of some grasps is not known")
    if result.refuted:
        lines.append(f"{_starts(result.refuted)} feasible for the solver, refuted by the independent check")
    for kind, blocked in sorted(result.blocked.items(), key=lambda item: -item[1].starts):
        lines.append(f"blocked by {kind}: {_starts(blocked.starts)}, nearest miss {_missed(blocked)}")
    return lines


def explanation_lines(explanation: Explanation) -> list[str]:
    """Return why a task finds no grasp and what would help, in words: bodies, figures, units."""
    lines = [f"refused: {explanation.refusal}"] if explanation.refusal else []
    if explanation.verified:
        lines.append(f"it works: {explanation.verified} of {_starts(explanation.done)} verified")
    elif not explanation.refusal:
        lines.append(f"none of {_starts(explanation.done)} verified")
    lines += [
        f"{100.0 * cause.share:3.0f} % {cause.kind}: nearest miss {_missed(cause)}" for cause in explanation.causes
    ]
    if explanation.nearest_miss is not None:
        figures = explanation.nearest_miss.certificate.refuted_by
        lines.append(
            f"nearest to a grasp: start {explanation.nearest_miss.start}, which does not keep {summary(figures)}"
        )
    for number, remedy in enumerate(explanation.remedies, 1):
        lines.append(f"remedy {number}: {remedy.text} (then {remedy.verified} of {_starts(remedy.tried)} verified)")
    if not (explanation.remedies or explanation.verified):
        lines.append("no single change that was tried helps")
    lines += [f"tried: {tried.text}, {tried.ending}" for tried in explanation.tried]
    if explanation.interrupted:
        lines.append("the search for remedies was ended before all changes were tried; more time: `deadline`")
    return lines


def _missed(cause: Blocked | Cause) -> str:
    miss = shown(cause.nearest_miss, cause.unit)
    return f"{miss} ({cause.where})" if cause.where else miss


def _starts(count: int) -> str:
    return "1 start" if count == 1 else f"{count} starts"
