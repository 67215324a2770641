"""A check in the terminal."""

from __future__ import annotations

from rich import box
from rich.markup import escape
from rich.table import Table

from .check import RobotReport
from .findings import Finding

STYLES = {"wrong": "bold red", "doubtful": "yellow", "ok": "green"}
"""What is worse comes first."""


def findings_table(report: RobotReport) -> Table:
    """Return the findings, the worst first, each with what to do below it."""
    table = _table(f"{report.name}: what the check found")
    table.show_header = False
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    for level, style in STYLES.items():
        for finding in report.findings:
            if finding.level == level:
                table.add_row(f"[{style}]{level}[/]", _in_words(finding))
    return table


def links_table(report: RobotReport) -> Table:
    """Return the figures of the links' collision geometry."""
    table = _table("collision geometry; how far its convex pieces stand off the meshes, mm")
    table.add_column("link", overflow="fold")
    for heading in ("triangles", "watertight", "pieces", "95 %", "most"):
        table.add_column(heading, justify="right", no_wrap=True)
    for link in report.links:
        counts = (f"{link.triangles}", "yes" if link.closed else "no", f"{link.pieces}")
        table.add_row(escape(link.link), *counts, f"{1e3 * link.excess:.1f}", f"{1e3 * link.most:.1f}")
    return table


def summary(report: RobotReport) -> str:
    """Return how many findings there are of each level."""
    counts = {level: sum(finding.level == level for finding in report.findings) for level in STYLES}
    return ", ".join(f"{count} {level}" for level, count in counts.items())


def _table(title: str) -> Table:
    return Table(title=title, box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False, pad_edge=False)


def _in_words(finding: Finding) -> str:
    return escape(finding.what) + (f"\n[dim]{escape(finding.remedy)}[/]" if finding.remedy else "")
