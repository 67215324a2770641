"""Starts and local solves: where to begin, projection on the contacts, solvers behind one interface."""

from .local import LocalSolver, Solution, SolverOptions
from .starts import starts_near

__all__ = ["LocalSolver", "Solution", "SolverOptions", "starts_near"]
