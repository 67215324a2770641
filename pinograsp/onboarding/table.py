"""A check in the terminal."""

from __future__ import annotations

from itertools import zip_longest

from ..tables import Table
from ..words import number_of
from .check import RobotReport

COLORS = {"wrong": "red", "doubtful": "yellow", "ok": "green"}


def findings_table(report: RobotReport) -> Table:
    """Return what is wrong, then what is doubtful, with what to do below it, and one line for all that is ok."""
    table = Table(f"{report.name}: findings", headings=False)
    table.lines("")
    table.words("")
    for finding, after in zip_longest(report.findings, report.findings[1:]):
        if finding.level != "ok":
            same = after is not None and (after.level, after.remedy) == (finding.level, finding.remedy)
            advice = "" if same or not finding.remedy else f"\n  {finding.remedy}"  # once, below the last of them
            table.add(finding.level, finding.what + advice, color=COLORS[finding.level])
    if fine := sum(finding.level == "ok" for finding in report.findings):
        what = number_of(fine, "thing")
        table.add("ok", f"{what} looked at, listed on the page and with --json", color=COLORS["ok"])
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
