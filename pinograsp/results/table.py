"""Results in the terminal."""

from __future__ import annotations

import math

from rich import box
from rich.table import Table

from .grasp import Result


def grasp_table(result: Result, rows: int = 10) -> Table:
    """Return a table of the best grasps that fits 80 columns with seven arm joints; clear is in mm."""
    title = f"{result.task}: best of {len(result.grasps)} distinct grasps, {result.robot} in {result.scene}"
    table = Table(title=title, box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False, pad_edge=False)
    for heading in ("", "found", "U", "Phi mm²", "V", "clear"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("   arm joints, degrees", no_wrap=True)
    for number, grasp in enumerate(result.grasps[:rows], 1):
        table.add_row(
            str(number),
            f"{grasp.count}x",
            f"{grasp.cost.U:.4g}",
            f"{grasp.cost.phi_mm2:.1e}",
            f"{grasp.cost.V:.3f}",
            f"{1e3 * grasp.certificate['enclosure clearance'].value:.1f}",
            "".join(f"{math.degrees(angle):5.0f}" for angle in grasp.q_arm),
        )
    return table


def outcome_lines(result: Result) -> list[str]:
    """Return what became of the starts, in words."""
    share = f" ({100 * result.reliable / result.done:.1f} %)" if result.done else ""
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in result.counts.items() if count)
    lines = [f"{result.reliable} of {result.done} starts reliable{share}; solver: {outcomes or 'no start'}"]
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
