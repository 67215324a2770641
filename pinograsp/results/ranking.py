"""The order of grasps, and the Pareto front.

**Tiers.** U decides where it differs by more than 1 % + 1 mm^2. Grasps are sorted by U. The first tier begins with the
least U, U_0, and holds every grasp with

    U <= U_0 + delta(U_0),    delta(U) = 0.01 |U| + 1 mm^2;

the next tier begins with the least U beyond it, and so on. So of two grasps a and b with U_b > U_a + delta(U_a), a
always comes first: were b in the tier of a, then U_b <= U_0 + delta(U_0) <= U_a + delta(U_a). Of two that are nearer to
each other, those of different tiers are ordered by U, and those of one tier by the score.

**Score.** In a tier of n grasps, the share of a criterion c for grasp g is the part of the others that it is better
than, ties counted half:

    s_c(g) = (#{h: c(h) worse} + 1/2 #{h != g: c(h) equal}) / (n - 1),    score(g) = mean over c of s_c(g).

The criteria are Q_force, clearance, reserve and manipulability (the `scored` ones of `criteria.CRITERIA`), every one
with the same weight. Values are equal if they are the same when rounded to the criterion's resolution (0.01 m/s^2,
0.1 mm, 1 mrad, 1e-4 m^3), so that rounding errors order nothing. A grasp without a value is worse than all that have
one; a criterion that none of the tier has is equal for all, and so is left out. Equal scores are ordered by U, equal U
by start. A grasp that is no worse in any criterion than another of its tier, and better in one, comes before it. Shares
are counted in whole numbers: the order is exact, and does not depend on the order in which the grasps come.

**Front.** Grasp h dominates g if it is no worse in every criterion and better in one, values rounded as above.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Array, Indices, Mask
from ..errors import InputError, require_kind
from .criteria import CRITERIA, criterion_of, numbers_of
from .grasp import Grasp

SCORE = "score"
"""Name of the default order."""
RELATIVE, ABSOLUTE = 0.01, 1.0
"""U decides beyond this part of it, and this many mm^2."""
FRONT = ("U", "Q_force", "clearance", "reserve")
"""Criteria of the Pareto front, where no others are given."""


def default_order(grasps: Sequence[Grasp]) -> list[int]:
    """Return the indices of grasps in the default order, the best first."""
    if not grasps:
        return []
    U = np.array([grasp.cost.U for grasp in grasps])
    tier, points = tiers(U), np.zeros(len(U), dtype=np.intp)
    numbers = [numbers_of(grasp) for grasp in grasps]
    for criterion in CRITERIA:
        if criterion.scored:
            points += _points(criterion.levels(numbers), tier)
    start = np.array([grasp.start for grasp in grasps])
    order: list[int] = np.lexsort((start, U, -points, tier)).tolist()
    return order


def ordered(grasps: Sequence[Grasp]) -> tuple[Grasp, ...]:
    """Return grasps in the default order, the best first."""
    return tuple(grasps[i] for i in default_order(grasps))


def ordered_by(grasps: Sequence[Grasp], by: str) -> tuple[Grasp, ...]:
    """Return grasps in the default order (`by` is "score"), or by one criterion alone, the best first.

    Equal values, not rounded, are in the default order; grasps without a value come last.

    Args:
        grasps: in any order.
        by: "score", or name of a criterion or of a figure.

    Raises:
        InputError: there is no such criterion or figure.
    """
    default = ordered(grasps)
    if by == SCORE:
        return default
    criterion = criterion_of(by, default, further=(SCORE,))
    merits = criterion.merits([numbers_of(grasp) for grasp in default])
    return tuple(default[i] for i in np.argsort(-merits, kind="stable"))


def pareto_front(grasps: Sequence[Grasp], criteria: Sequence[str] = FRONT) -> tuple[Grasp, ...]:
    """Return the grasps that no other dominates, in the default order; of equal ones all.

    Args:
        grasps: in any order.
        criteria: names of criteria or of figures.

    Raises:
        InputError: there is no such criterion or figure.
    """
    require_kind("criteria", criteria, Sequence)
    if isinstance(criteria, str):  # a sequence, too, but of letters
        names = [name.strip() for name in criteria.split(",")]
        raise InputError(f"a list of names is wanted, not {criteria!r}", key="criteria", remedy=f"Give {names}")
    default = ordered(grasps)
    if not default or not criteria:
        return default
    numbers = [numbers_of(grasp) for grasp in default]
    levels = np.array([criterion_of(name, default, key="criteria").levels(numbers) for name in criteria]).T
    distinct, which = np.unique(levels, axis=0, return_inverse=True)
    return tuple(default[i] for i in np.flatnonzero(_undominated(distinct)[which.reshape(-1)]))


def tiers(U: Array) -> Indices:
    """Return the number of each grasp's tier, from 0, shape (n,), by its U, shape (n,)."""
    ascending = np.sort(U)
    begins = [ascending[0]]
    while (beyond := np.searchsorted(ascending, begins[-1] + RELATIVE * abs(begins[-1]) + ABSOLUTE, "right")) < len(U):
        begins.append(ascending[beyond])
    return np.searchsorted(np.array(begins), U, side="right") - 1


def _points(levels: Array, tier: Indices) -> Indices:
    """Return 2 (n - 1) s_c of every grasp: two for each of its tier that it is better than, one for each equal one."""
    order = np.lexsort((levels, tier))
    place = np.arange(len(order))
    new_tier = np.append(True, np.diff(tier[order]) != 0)
    new_run = new_tier | np.append(True, levels[order][1:] != levels[order][:-1])
    worse = np.maximum.accumulate(place * new_run) - np.maximum.accumulate(place * new_tier)
    run = np.cumsum(new_run) - 1
    points = np.empty_like(place)
    points[order] = 2 * worse + np.bincount(run)[run] - 1
    return points


def _undominated(levels: Array) -> Mask:
    """Return which of distinct rows, shape (n, criteria), no other is nowhere below; shape (n,)."""
    # What dominates a row is greater in lexicographic order, too: it came before, or was itself dominated by what did.
    front: list[int] = []
    for i in np.lexsort(levels.T)[::-1]:
        if not (levels[front] >= levels[i]).all(axis=1).any():
            front.append(int(i))
    found = np.zeros(len(levels), dtype=bool)
    found[front] = True
    return found
