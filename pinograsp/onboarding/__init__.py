"""Robots that pinograsp does not know yet: a first robot file for a URDF, and a check of any robot file."""

from .check import Report, check_robot
from .findings import Finding, LinkFigures
from .new import HandMount, new_robot_file, refuse_existing, summary_lines, write_new
from .table import findings_table, links_table, summary

__all__ = [
    "Finding",
    "HandMount",
    "LinkFigures",
    "Report",
    "check_robot",
    "findings_table",
    "links_table",
    "new_robot_file",
    "refuse_existing",
    "summary",
    "summary_lines",
    "write_new",
]
