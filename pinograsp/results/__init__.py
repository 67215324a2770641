"""Results: grasps with their cost, contacts and certificate, merged, sorted, written and shown as a table."""

from .assemble import claim_of, grasp_of
from .encoding import FORMAT_VERSION
from .grasp import Blocked, Contact, Cost, Grasp, Result
from .json import read_json, write_json
from .merge import merge
from .provenance import file_hashes, provenance
from .reverify import Difference, verify
from .setup import Setup
from .table import grasp_table, outcome_lines

__all__ = [
    "FORMAT_VERSION",
    "Blocked",
    "Contact",
    "Cost",
    "Difference",
    "Grasp",
    "Result",
    "Setup",
    "claim_of",
    "file_hashes",
    "grasp_of",
    "grasp_table",
    "merge",
    "outcome_lines",
    "provenance",
    "read_json",
    "verify",
    "write_json",
]
