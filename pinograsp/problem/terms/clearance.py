"""Clearance of every link: a smooth lower bound of its distances less their margins.

What a distance has above its margin, a = d - margin, enters as phi(a), which is a up to `NEAR`, bends, and is
constant from `REACH` on, twice continuously differentiable. Pairs that culling leaves out have a >= REACH, so that
they enter with the value that measuring them would have given: culling changes nothing.

The pairs of a link are joined by the smooth minimum

    -rho log sum_j exp(-phi(a_j) / rho)  <=  min_j phi(a_j)
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ...models.collision import REACH, Pair
from ..state import State, TaskModel
from .residual import Residual

NEAR = 0.015
"""What a distance has above its margin enters unchanged below this, m."""
SMOOTHING = 0.0003
"""rho of the smooth minimum, m: it lies at most rho log(pairs) below the minimum."""
_SPAN = REACH - NEAR
FAR = NEAR + 0.5 * _SPAN
"""phi of everything from REACH on, m."""


class Clearance:
    """The term with its pairs, margins and links."""

    def __init__(self, model: TaskModel) -> None:
        pairs = model.collisions.pairs
        self.links = tuple(dict.fromkeys(pair.link for pair in pairs))
        self._pairs = pairs
        self._margins = np.array([pair.margin for pair in pairs])
        self._link_of = np.array([self.links.index(pair.link) for pair in pairs])
        self._counts = np.bincount(self._link_of, minlength=len(self.links))

    def __call__(self, state: State) -> Residual:
        """Return the clearance of every link, m, shape (links,)."""
        measured = state.distances
        links = self._link_of[measured.indices]
        above, slopes = _bent(measured.values - self._margins[measured.indices])
        # Shift by each link's least value so that exp neither overflows nor vanishes.
        least = np.full(len(self.links), FAR)
        np.minimum.at(least, links, above)
        weights = np.exp((least[links] - above) / SMOOTHING)
        far = self._counts - np.bincount(links, minlength=len(self.links))
        sums = np.bincount(links, weights, len(self.links)) + far * np.exp((least - FAR) / SMOOTHING)
        clearances = least - SMOOTHING * np.log(sums)
        jacobian = np.zeros((len(self.links), len(state.x)))
        shares = (weights / sums[links] * slopes)[:, None] * measured.gradients
        np.add.at(jacobian[:, : measured.gradients.shape[1]], links, shares)
        return Residual(clearances, jacobian)

    def worst(self, state: State) -> dict[str, tuple[float, Pair]]:
        """Return, per kind of pair, the least distance less its margin (m), unsmoothed, and its pair."""
        measured = state.distances
        above = measured.values - self._margins[measured.indices]
        worst: dict[str, tuple[float, Pair]] = {}
        for index, value in zip(measured.indices.tolist(), above.tolist(), strict=True):
            pair = self._pairs[index]
            if pair.kind not in worst or value < worst[pair.kind][0]:
                worst[pair.kind] = (value, pair)
        return worst


def _bent(above: Array) -> tuple[Array, Array]:
    """Return phi and its slope."""
    t = np.clip((above - NEAR) / _SPAN, 0.0, 1.0)
    cube = t * t * t
    values = np.where(above <= NEAR, above, NEAR + _SPAN * (t - cube + 0.5 * t * cube))
    return values, 1.0 - 3.0 * t * t + 2.0 * cube
