"""Results: grasps with their cost, contacts and certificate, merged, sorted, written and shown as a table."""

from .assemble import claim_of, grasp_of
from .grasp import Blocked, Contact, Cost, Grasp, Result
from .json import FORMAT_VERSION, read_json, write_json
from .merge import merge
from .provenance import provenance
from .table import grasp_table, outcome_lines

__all__ = [
    "FORMAT_VERSION",
    "Blocked",
    "Contact",
    "Cost",
    "Grasp",
    "Result",
    "claim_of",
    "grasp_of",
    "grasp_table",
    "merge",
    "outcome_lines",
    "provenance",
    "read_json",
    "write_json",
]
