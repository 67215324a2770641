"""Results: grasps with their cost, contacts and certificate, merged, ranked, written and shown as a table.

Reading one loads no library of robots or geometry. `reverify` recomputes a result, with the verification.
"""

from .criteria import CRITERIA, Criterion
from .different import Different
from .encoding import FORMAT_VERSION
from .grasp import Contact, Cost, Grasp
from .json import read_json, write_json
from .merge import merge
from .ranking import ordered
from .result import WITHSTAND, Blocked, Result
from .setup import Setup

__all__ = [
    "CRITERIA",
    "FORMAT_VERSION",
    "WITHSTAND",
    "Blocked",
    "Contact",
    "Cost",
    "Criterion",
    "Different",
    "Grasp",
    "Result",
    "Setup",
    "merge",
    "ordered",
    "read_json",
    "write_json",
]
