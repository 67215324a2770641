"""Results: grasps with their cost, contacts and certificate, merged, ranked, written and shown as a table."""

from .assemble import claim_of, grasp_of
from .criteria import CRITERIA, Criterion
from .different import Different
from .encoding import FORMAT_VERSION
from .grasp import Contact, Cost, Grasp
from .json import read_json, write_json
from .merge import merge
from .provenance import file_hashes, provenance
from .ranking import ordered
from .result import WITHSTAND, Blocked, Result
from .reverify import Difference, verify
from .setup import Setup
from .table import grasp_table, outcome_lines

__all__ = [
    "CRITERIA",
    "FORMAT_VERSION",
    "WITHSTAND",
    "Blocked",
    "Contact",
    "Cost",
    "Criterion",
    "Difference",
    "Different",
    "Grasp",
    "Result",
    "Setup",
    "claim_of",
    "file_hashes",
    "grasp_of",
    "grasp_table",
    "merge",
    "ordered",
    "outcome_lines",
    "provenance",
    "read_json",
    "verify",
    "write_json",
]
