"""Words of the solver that results keep."""

from __future__ import annotations

from typing import Literal

Outcome = Literal["converged", "feasible", "infeasible", "budget spent", "failed"]
"""Outcomes of a start. With the constraints kept at the best point: the solver stopped by itself, or did not. With
some violated there: the solver stopped by itself, its budget ended, or it raised an error."""
Projection = Literal["nothing", "contacts", "contacts and clearance"]
"""Conditions of a grasp that a start is projected on."""
