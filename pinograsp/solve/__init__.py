"""Starts and local solves: where to begin, projection on the contacts, NLopt, worker processes."""

from .local import ALGORITHMS, LocalSolver, Solution, SolverOptions
from .pool import work
from .starts import sample_starts

__all__ = ["ALGORITHMS", "LocalSolver", "Solution", "SolverOptions", "sample_starts", "work"]
