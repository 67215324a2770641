"""Openings of a surface, and where they make winding numbers doubtful.

Where a surface is closed, winding numbers are whole. Each of its openings takes from them the solid angle under which
it is seen over 4 pi. What is in a ball of radius r, its border going round once, is seen from a distance R of the
middle within a cone, whose share of all directions is (1 - sqrt(1 - (r / R)^2)) / 2. Where these shares add up to less
than `DOUBT` all along a way that crosses no triangle, the winding number is so near to a whole one, and to the same one
at both ends.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh

from ..arrays import Array, Integers, Mask
from ..compiled import compiled
from .pieces import edges_of

DOUBT = 0.25
"""Share of all directions in which openings are, beyond which the winding number is asked for."""


class Openings:
    """Balls around the openings of a surface.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """

    def __init__(self, vertices: Array, faces: Integers) -> None:
        ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        edges, numbers = edges_of(ends)
        net = np.abs(np.bincount(numbers, weights=np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0), minlength=len(edges)))
        border, often = edges[net > 0.0], net[net > 0.0]
        loops: list[Any] = trimesh.graph.connected_components(border, nodes=np.unique(border)) if len(border) else []
        times = np.zeros(len(vertices))
        np.maximum.at(times, border[:, 0], often)
        boxes = [0.5 * (vertices[loop].min(axis=0) + vertices[loop].max(axis=0)) for loop in loops]
        self._centers = np.array(boxes).reshape(-1, 3)
        self._radii = np.array(
            [np.linalg.norm(vertices[loop] - center, axis=1).max() for loop, center in zip(loops, boxes, strict=True)]
        )
        self._times = np.array([times[loop].max() for loop in loops])

    def near(self, points: Array, radii: Array) -> Mask:
        """Return in which balls, shape (n,), winding numbers may be doubtful.

        Args:
            points: middles of the balls, shape (n, 3), m.
            radii: shape (n,), m.
        """
        return _near(np.ascontiguousarray(points), radii, self._centers, self._radii, self._times, DOUBT)


@compiled
def _near(points: Array, reach: Array, centers: Array, radii: Array, times: Array, doubt: float) -> Mask:
    found = np.zeros(len(points), dtype=np.bool_)
    for i in range(len(points)):
        share = 0.0
        for k in range(len(centers)):
            square = 0.0
            for axis in range(3):
                square += (points[i, axis] - centers[k, axis]) ** 2
            away = np.sqrt(square) - reach[i]
            if away <= radii[k]:
                share = np.inf
                break
            share += times[k] * 0.5 * (1.0 - np.sqrt(1.0 - (radii[k] / away) ** 2))
        found[i] = share > doubt
    return found
