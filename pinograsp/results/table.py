"""Results in the terminal."""

from __future__ import annotations

import math

from rich import box
from rich.table import Table

from .criteria import CRITERIA, numbers_of
from .ranking import SCORE
from .result import Result


def grasp_table(result: Result, rows: int = 10, by: str = SCORE) -> Table:
    """Return a table of the best grasps that differ from each other; it fits 80 columns with seven arm joints.

    Grasps go by their numbers in the result, from 1; `found` counts the starts of all grasps that one stands for.

    Args:
        result: with a grasp or more.
        rows: number of grasps at most.
        by: the order in which they are chosen, as for `Result.ranked`.

    Raises:
        InputError: there is no such criterion or figure.
    """
    shown = result.different(rows, by)
    numbers = {id(grasp): number for number, grasp in enumerate(result.grasps, 1)}
    title = f"{result.task}: {len(shown)} different of {len(result.grasps)} distinct grasps"
    title += f", {result.robot} in {result.scene}"
    table = Table(title=title, box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False, pad_edge=False)
    table.caption = None if by == SCORE else f"by {by}"
    columns = [criterion for criterion in CRITERIA if criterion.narrow]
    for heading in ("", "found", *(f"{criterion.heading}\n{criterion.shown_unit}" for criterion in columns)):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("   arm joints\n   °", no_wrap=True)
    for grasp, starts, _ in shown:
        table.add_row(
            str(numbers[id(grasp)]),
            f"{starts}x",
            *(criterion.cell(numbers_of(grasp)) for criterion in columns),
            "".join(f"{math.degrees(angle):5.0f}" for angle in grasp.q_arm),
        )
    return table


def outcome_lines(result: Result) -> list[str]:
    """Return what became of the starts, in words."""
    share = f" ({100 * result.verified / result.done:.1f} %)" if result.done else ""
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in result.counts.items() if count)
    lines = [f"{result.verified} of {result.done} starts verified{share}; solver: {outcomes or 'no start'}"]
    if result.done < result.starts:
        reason = "interrupted" if result.interrupted else "no more collision-free starts near the object were found"
        lines.append(f"{result.starts - result.done} of {result.starts} starts not tried: {reason}")
    if result.refuted:
        lines.append(f"{result.refuted} starts feasible for the solver, refuted by the independent check")
    for kind, blocked in sorted(result.blocked.items(), key=lambda item: -item[1].starts):
        miss = f"{blocked.nearest_miss:.3g} {blocked.unit}".strip()
        where = f" ({blocked.where})" if blocked.where else ""
        lines.append(f"blocked by {kind}: {blocked.starts} starts, nearest miss {miss}{where}")
    return lines
