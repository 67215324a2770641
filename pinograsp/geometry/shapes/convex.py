"""What the surfaces of convex shapes have in common: they are of one part."""

from __future__ import annotations

import numpy as np

from ...arrays import Array, Indices


class Convex:
    """A shape that is no compound."""

    edged = True

    def nearest_part(self, points: Array) -> Indices:
        """Return 0 for every point."""
        return np.zeros(len(points), dtype=np.intp)
