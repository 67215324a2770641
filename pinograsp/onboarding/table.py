"""A check in the terminal."""

from __future__ import annotations

from ..tables import Table
from .check import RobotReport
from .findings import Finding

COLORS = {"wrong": "red", "doubtful": "yellow", "ok": "green"}
"""What is worse comes first."""


def findings_table(report: RobotReport) -> Table:
    """Return the findings, the worst first, each with what to do below it."""
    table = Table(f"{report.name}: findings", headings=False)
    table.lines("")
    table.words("")
    for level, color in COLORS.items():
        for finding in report.findings:
            if finding.level == level:
                table.add(level, _in_words(finding), color=color)
    return table


def links_table(report: RobotReport) -> Table:
    """Return the figures of the links' collision geometry."""
    table = Table("collision geometry; how far its convex pieces stand off the meshes, mm")
    table.words("link")
    table.numbers("triangles", "watertight", "pieces", "95 %", "most")
    for link in report.links:
        counts = (f"{link.triangles}", "yes" if link.closed else "no", f"{link.pieces}")
        table.add(link.link, *counts, f"{1e3 * link.excess:.1f}", f"{1e3 * link.most:.1f}")
    return table


def summary(report: RobotReport) -> str:
    """Return how many findings there are of each level."""
    counts = {level: sum(finding.level == level for finding in report.findings) for level in COLORS}
    return ", ".join(f"{count} {level}" for level, count in counts.items())


def _in_words(finding: Finding) -> str:
    return finding.what + (f"\n  {finding.remedy}" if finding.remedy else "")
