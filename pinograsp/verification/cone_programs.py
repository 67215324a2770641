"""Linear functions maximised over cones: second-order cone programs of one structure, solved side by side.

A program is   max a  with  E x + a g = load  and  C x + c - a h  in a product of half-lines and second-order cones.
Several of them, which differ in g and h only, are solved as one block-diagonal program: the maximum of the sum is the
sum of the maxima.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import clarabel
import numpy as np
from scipy import sparse

from ..arrays import Array, Indices, Mask

_TOLERANCE = 1e-9
_SOLVED = (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)
_UNBOUNDED = (clarabel.SolverStatus.DualInfeasible, clarabel.SolverStatus.AlmostDualInfeasible)
_IMPOSSIBLE = (clarabel.SolverStatus.PrimalInfeasible, clarabel.SolverStatus.AlmostPrimalInfeasible)


@dataclass(frozen=True)
class Cones:
    """The inequalities as cones: C x + c lies in a product of half-lines and second-order cones."""

    rows: Array
    """C, shape (m, n): half-lines first."""
    offsets: Array
    """c, N, shape (m,)."""
    heads: Mask
    """Which rows have to be large: the half-lines and the first row of each second-order cone, shape (m,)."""
    half_lines: int
    sizes: tuple[int, ...]
    """Rows of each second-order cone."""


def maximised(E: Array, load: Array, cones: Cones, growth: Array, *, positive: bool) -> Array:
    """Return for each row of `growth` the largest a with E x + a g = load and C x + c - a h in the cones.

    Infinite where nothing bounds it, not a number where the solver fails.

    Args:
        E: shape (r, n).
        load: shape (r,).
        cones: C, c and what they are.
        growth: g and h of each program, shape (programs, r + m).
        positive: whether a may not be negative.
    """
    programs, equations = len(growth), len(E)
    more = int(positive)  # a row below E: -a <= 0
    block = np.vstack([E, np.zeros((more, E.shape[1])), -cones.rows])
    sides = np.concatenate([load, np.zeros(more), cones.offsets])
    last = np.hstack([growth[:, :equations], np.full((programs, more), -1.0), growth[:, equations:]])
    used = block != 0.0
    pattern = _pattern(used.tobytes(), used.shape, equations, cones.half_lines + more, cones.sizes, programs)
    A, b = pattern.filled(block.T[used.T], last, sides)
    for careful in (False, True):
        solver = clarabel.DefaultSolver(pattern.P, pattern.q, A, b, pattern.kinds, _settings(careful))
        solution = solver.solve()
        if solution.status in _UNBOUNDED:
            break
        if solution.status in _SOLVED:
            found = np.asarray(solution.x)[pattern.q < 0.0]
            return np.maximum(found, 0.0) if positive else found
    if positive and solution.status in _IMPOSSIBLE:
        return np.zeros(programs)
    if programs > 1:  # one that is unbounded, or fails, says nothing of the others
        each = [maximised(E, load, cones, one[None], positive=positive) for one in growth]
        return np.concatenate(each)
    return np.array([math.inf if solution.status in _UNBOUNDED else math.nan])


@dataclass(frozen=True)
class _Pattern:
    """Programs of one structure side by side, as Clarabel takes them: min q y with A y + s = b, s in the cones.

    y is x and a of program after program; rows are all equations first, then all half-lines, then the second-order
    cones of program after program.
    """

    P: Any
    q: Array
    kinds: list[Any]
    indices: Indices
    """Row of every number of A, column after column."""
    starts: Indices
    """First number of each column of A."""
    place: Indices
    """Row of A for every row of every program, shape (programs, rows)."""

    def filled(self, block: Array, growth: Array, sides: Array) -> tuple[Any, Array]:
        """Return A and b.

        Args:
            block: the numbers of a program's block without its last column, column after column.
            growth: last column of each program, shape (programs, rows).
            sides: right-hand side of a program, shape (rows,).
        """
        programs = len(self.place)
        data = np.concatenate([np.broadcast_to(block, (programs, len(block))), growth], axis=1)
        shape = (self.place.size, len(self.q))
        b = np.empty(self.place.size)
        b[self.place] = sides
        return sparse.csc_matrix((data.ravel(), self.indices, self.starts), shape=shape), b


@lru_cache(maxsize=64)
def _pattern(
    used: bytes, shape: tuple[int, int], equations: int, lines: int, sizes: tuple[int, ...], programs: int
) -> _Pattern:
    """Return the pattern of programs; most grasps of a task have the same one.

    Args:
        used: which numbers of a program's block without its last column are not zero.
        shape: of that block.
        equations: its first rows.
        lines: half-lines, its next rows.
        sizes: rows of each second-order cone, its last rows.
        programs: their number.
    """
    (rows, n), full = shape, np.ones((shape[0], 1), dtype=bool)
    block = np.hstack([np.frombuffer(used, dtype=bool).reshape(shape), full])
    column, row = np.nonzero(block.T)
    parts = np.array([equations, lines, rows - equations - lines])
    begins = np.cumsum([0, *(parts * programs)])
    kind = np.repeat(np.arange(3), parts)
    within = np.concatenate([np.arange(part) for part in parts])
    place = (begins[kind] + within) + np.arange(programs)[:, None] * parts[kind]
    firsts = np.searchsorted(column, np.arange(n + 1)) + np.arange(programs)[:, None] * len(row)
    q = np.zeros(programs * (n + 1))
    q[n :: n + 1] = -1.0
    kinds = [clarabel.ZeroConeT(equations * programs), clarabel.NonnegativeConeT(lines * programs)]
    kinds += [clarabel.SecondOrderConeT(size) for size in sizes] * programs
    starts = np.append(firsts, programs * len(row))
    return _Pattern(sparse.csc_matrix((len(q), len(q))), q, kinds, place[:, row].ravel(), starts, place)


@cache
def _settings(careful: bool) -> Any:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.presolve_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = _TOLERANCE
    settings.reduced_tol_gap_abs = settings.reduced_tol_gap_rel = settings.reduced_tol_feas = (
        100 if careful else 10
    ) * _TOLERANCE
    # The rows are of one unit and size as they are: neither equilibration nor refinement changes much but the time.
    settings.equilibrate_enable = settings.iterative_refinement_enable = careful
    return settings
