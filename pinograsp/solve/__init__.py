"""Starts and local solves: where to begin, projection on the contacts, NLopt."""

from .local import ALGORITHMS, LocalSolver, Solution, SolverOptions
from .starts import sample_starts

__all__ = ["ALGORITHMS", "LocalSolver", "Solution", "SolverOptions", "sample_starts"]
