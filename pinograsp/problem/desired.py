"""Where contacts are wanted: the desired contacts of a task, or a pair of points that is proposed to one start."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import Array


class DesiredPoints(NamedTuple):
    """Points of the object's surface, one for each pad."""

    points: Array
    """World, m, shape (n, 3)."""
    normals: Array
    """Outward normals of the surface there that pads are to look at; zero where any will do, shape (n, 3).

    Of the desired contacts of a task those on flat faces and uneven surfaces have one, of points that are proposed all.
    """
