"""Clearance: every link keeps its margins from walls, obstacles, the object and the robot itself, (15), (16).

A row is a smooth lower bound of the distances of a link less their margins.

What a distance has above its margin, a = d - margin, enters as phi(a), which is a up to `NEAR`, bends, and is
constant from `REACH` on, twice continuously differentiable. Pairs that culling leaves out have a >= REACH, so that
they enter with the value that measuring them would have given: culling changes nothing.

The pairs of a link are joined by the smooth minimum

    -rho log sum_j exp(-phi(a_j) / rho)  <=  min_j phi(a_j)
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ...arrays import Array, Indices
from ...collision.distances import REACH
from ...collision.world import CLEARANCES
from ...compiled import compiled
from ..constraint import PER_METRE, Descents, Inside, Residual, Violation
from ..state import State
from ..task_model import TaskModel

NEAR = 0.015
"""A distance less its margin enters unchanged below this, m."""
SMOOTHING = 0.0003
"""rho of the smooth minimum, m: it lies at most rho log(pairs) below the minimum."""


class Clearance(Inside):
    """Clearance of every link, m."""

    name = "clearance"
    figures: Mapping[str, str] = dict.fromkeys(CLEARANCES.values(), "mm")
    descents: Descents = "clearances"
    scale = PER_METRE
    least = 0.0

    def __init__(self, model: TaskModel) -> None:
        self._pairs, self._grouped = model.collisions.pairs, model.collisions.link_pairs
        self.links = self._grouped.links
        """Links of the rows."""
        self.rows = tuple(f"clearance of {link}" for link in self.links)

    def inside(self, state: State) -> Residual:
        indices, above, gradients = self._measured(state)
        links, counts = self._grouped.link_of[indices], self._grouped.counts
        values, jacobian = smooth_minima(above, gradients, links, counts, REACH)
        rest = np.zeros((len(values), len(state.x) - jacobian.shape[1]))
        return Residual(values, np.concatenate([jacobian, rest], axis=1))

    def _measured(self, state: State) -> tuple[Indices, Array, Array]:
        """Return the pairs that were measured, their distances above their margins, m, and the gradients."""
        measured, margins = state.distances, self._grouped.margins
        count = int(np.searchsorted(measured.indices, len(margins)))
        indices = measured.indices[:count]
        return indices, measured.values[:count] - margins[indices], measured.gradients[:count]

    def violations(self, state: State) -> list[Violation]:
        """Return the violation of each figure of which a pair was measured."""
        indices, above, _ = self._measured(state)
        worst: dict[str, tuple[float, str]] = {}
        for index, value in zip(indices.tolist(), above.tolist(), strict=True):
            pair = self._pairs[index]
            if pair.kind not in worst or value < worst[pair.kind][0]:
                worst[pair.kind] = (value, pair.name)
        missing = [(name, max(0.0, -1e3 * least), pair) for name, (least, pair) in worst.items()]
        return [Violation(name, value, "mm", pair, size=value) for name, value, pair in missing]


@compiled
def smooth_minima(above: Array, gradients: Array, links: Indices, counts: Indices, reach: float) -> tuple[Array, Array]:
    """Return the smooth minimum of every link and its gradient, shapes (links,), (links, v).

    Args:
        above: distances less margins of the pairs that were measured, m, shape (k,).
        gradients: of these, shape (k, v).
        links: link of every pair, shape (k,).
        counts: pairs of every link, measured or not, shape (links,).
        reach: where phi has become constant, m.
    """
    bent, slopes = np.empty(len(above)), np.empty(len(above))
    everything_far = bend(reach, reach)[0]
    # Shifted by each link's least value, so that exp neither overflows nor vanishes.
    least, far = np.full(len(counts), everything_far), counts.copy()
    for pair in range(len(above)):
        bent[pair], slopes[pair] = bend(above[pair], reach)
        if above[pair] < reach:  # else it counts as one that was not measured, to the last bit
            least[links[pair]] = min(least[links[pair]], bent[pair])
            far[links[pair]] -= 1
    weights, sums = np.zeros(len(above)), far * np.exp((least - everything_far) / SMOOTHING)
    for pair in range(len(above)):
        if above[pair] >= reach:
            continue
        weights[pair] = math.exp((least[links[pair]] - bent[pair]) / SMOOTHING)
        sums[links[pair]] += weights[pair]
    jacobian = np.zeros((len(counts), gradients.shape[1]))
    for pair in range(len(above)):
        share = weights[pair] / sums[links[pair]] * slopes[pair]
        for variable in range(gradients.shape[1]):
            jacobian[links[pair], variable] += share * gradients[pair, variable]
    return least - SMOOTHING * np.log(sums), jacobian


@compiled
def bent_rows(
    above: Array, gradients: Array, rows: Indices, count: int, variables: int, reach: float
) -> tuple[Array, Array]:
    """Return phi of values that are rows of their own and its gradient, shapes (rows,), (rows, variables).

    Args:
        above: distances less margins of the rows that were measured, m, shape (k,).
        gradients: of these in the first variables, shape (k, p).
        rows: which they are, shape (k,).
        count: rows, measured or not.
        variables: number of these.
        reach: where phi has become constant, m.
    """
    values, jacobian = np.full(count, bend(reach, reach)[0]), np.zeros((count, variables))
    for k in range(len(above)):
        values[rows[k]], slope = bend(above[k], reach)
        for variable in range(gradients.shape[1]):
            jacobian[rows[k], variable] = slope * gradients[k, variable]
    return values, jacobian


@compiled
def bend(above: float, reach: float) -> tuple[float, float]:
    """Return phi and its slope, for one value, m."""
    span = reach - NEAR
    t = min(max((above - NEAR) / span, 0.0), 1.0)
    cube = t * t * t
    phi = above if t == 0.0 else NEAR + span * (t - cube + 0.5 * t * cube)
    return phi, 1.0 - 3.0 * t * t + 2.0 * cube
