"""Starts and local solves: where to begin, projection on the contacts, NLopt, worker processes."""

from .local import ALGORITHMS, Solution, SolverOptions, solve
from .pool import Progress, solve_all
from .starts import sample_starts

__all__ = ["ALGORITHMS", "Progress", "Solution", "SolverOptions", "sample_starts", "solve", "solve_all"]
