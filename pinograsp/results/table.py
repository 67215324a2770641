"""Results in the terminal."""

from __future__ import annotations

import math

from rich.table import Table

from .grasp import Result


def grasp_table(result: Result, rows: int = 10) -> Table:
    """Return a table of the best grasps."""
    table = Table(title=f"{result.task}: best of {len(result.grasps)} verified grasps, {result.robot} in {result.scene}")
    for heading in ("#", "found", "U", "Phi mm²", "V", "|force| N", "clearance mm", "arm joints rad"):
        table.add_column(heading, justify="left" if heading.startswith("arm") else "right", no_wrap=True)
    for number, grasp in enumerate(result.grasps[:rows], 1):
        forces = ", ".join(f"{math.dist(c.force, (0, 0, 0)):.3f}" for c in grasp.contacts)
        angles = [f"{angle: .2f}" for angle in grasp.q_arm]
        table.add_row(
            str(number),
            f"{grasp.count}x",
            f"{grasp.cost.U:.4f}",
            f"{grasp.cost.phi_mm2:.2e}",
            f"{grasp.cost.V:.4f}",
            forces,
            f"{1e3 * grasp.certificate['enclosure clearance'].value:.1f}",
            " ".join(angles),
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
