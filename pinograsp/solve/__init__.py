"""Starts and local solves: where to begin, projection on the contacts, solvers behind one interface."""

from .local import LocalSolver, Solution, SolverOptions
from .start_index import HeldHand, StartIndex
from .starts import starts_near

__all__ = ["HeldHand", "LocalSolver", "Solution", "SolverOptions", "StartIndex", "starts_near"]
