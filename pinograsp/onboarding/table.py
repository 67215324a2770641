"""A check in the terminal."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from ..tables import new_table, numbers, words
from .check import RobotReport
from .findings import Finding

STYLES = {"wrong": "bold red", "doubtful": "yellow", "ok": "green"}
"""What is worse comes first."""


def findings_table(report: RobotReport) -> Table:
    """Return the findings, the worst first, each with what to do below it."""
    table = new_table(f"{report.name}: findings", headings=False)
    table.add_column(no_wrap=True)
    words(table, "")
    for level, style in STYLES.items():
        for finding in report.findings:
            if finding.level == level:
                table.add_row(f"[{style}]{level}[/]", _in_words(finding))
    return table


def links_table(report: RobotReport) -> Table:
    """Return the figures of the links' collision geometry."""
    table = new_table("collision geometry; how far its convex pieces stand off the meshes, mm")
    words(table, "link")
    numbers(table, "triangles", "watertight", "pieces", "95 %", "most")
    for link in report.links:
        counts = (f"{link.triangles}", "yes" if link.closed else "no", f"{link.pieces}")
        table.add_row(escape(link.link), *counts, f"{1e3 * link.excess:.1f}", f"{1e3 * link.most:.1f}")
    return table


def summary(report: RobotReport) -> str:
    """Return how many findings there are of each level."""
    counts = {level: sum(finding.level == level for finding in report.findings) for level in STYLES}
    return ", ".join(f"{count} {level}" for level, count in counts.items())


def _in_words(finding: Finding) -> str:
    return escape(finding.what) + (f"\n[dim]{escape(finding.remedy)}[/]" if finding.remedy else "")
