"""Where contacts are wanted: the desired contacts of a task, or a pair of points that is proposed to one start."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import Array


class DesiredPoints(NamedTuple):
    """Points of the object's surface, one for each pad."""

    points: Array
    """World, m, shape (n, 3)."""
    normals: Array
    """Outward normals of the flat faces that the points are on; zero on curved parts, shape (n, 3)."""
