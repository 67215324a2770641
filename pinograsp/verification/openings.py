"""Openings of a surface, and where they make winding numbers doubtful.

Where a surface is closed, winding numbers are whole. Let each of its openings be closed by a fan of triangles over its
border. Then it is closed, and the opening takes from the winding number the solid angle under which the fan is seen
over 4 pi, its share of all directions. Two bounds of that are known, and the smaller one counts:

- What is in a ball of radius r, its border going round once, is seen from a distance R of the middle within a cone,
  whose share is (1 - sqrt(1 - (r / R)^2)) / 2.
- A triangle of area A is seen from places that are D away from it, at least, under A / D^2 at most. It is in a rod: no
  farther from its longest edge than its height over that. Slits have long rods, and next to no area.

Where these shares add up to less than `DOUBT` all along a way that crosses no triangle, the winding number is so near
to a whole one, and to the same one at both ends.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh

from ..arrays import Array, Indices, Integers, Mask
from ..compiled import compiled
from .pieces import edges_of

DOUBT = 0.25
"""Share of all directions in which openings are, beyond which the winding number is asked for."""
EXACTLY = 0.01
"""Share of an opening, as seen from a ball around a way, beyond which it is asked for from the way itself."""


class Openings:
    """Balls around the openings of a surface, and rods around the triangles of fans over them.

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
        centers = np.array(boxes).reshape(-1, 3)
        loop_of = np.zeros(len(vertices), dtype=np.intp)
        for number, loop in enumerate(loops):
            loop_of[loop] = number
        order = loop_of[border[:, 0]].argsort(kind="stable")
        of = loop_of[border[order, 0]]
        fans = np.concatenate([vertices[border[order]], centers[of][:, None]], axis=1)
        across = np.cross(fans[:, 1] - fans[:, 0], fans[:, 2] - fans[:, 0])
        areas = 0.5 * often[order] * np.sqrt((across * across).sum(axis=1))
        radii = [np.linalg.norm(vertices[loop] - box, axis=1).max() for loop, box in zip(loops, boxes, strict=True)]
        self._balls = centers, np.array(radii), np.array([times[loop].max() for loop in loops])
        starts = np.searchsorted(of, np.arange(len(loops) + 1)).astype(np.intp)
        longest, heights = rods(fans)
        self._rods = starts, longest, heights, areas

    def near(self, ends: Array, radii: Array) -> Mask:
        """Return along which straight ways, or near to them, winding numbers may be doubtful, shape (n,).

        Args:
            ends: of the ways, shape (n, 2, 3), m.
            radii: how far from them, shape (n,), m.
        """
        centers, reaches, times = self._balls
        return _near(np.ascontiguousarray(ends), radii, centers, reaches, times, *self._rods, DOUBT, EXACTLY)


def rods(triangles: Array) -> tuple[Array, Array]:
    """Return the ends of the longest edges of triangles, shape (n, 2, 3), and their heights over these, m, shape (n,).

    Args:
        triangles: shape (n, 3 corners, 3), m.
    """
    edges = np.roll(triangles, -1, axis=1) - triangles
    lengths = np.sqrt((edges * edges).sum(axis=2))
    rows, longest = np.arange(len(triangles)), lengths.argmax(axis=1)
    ends = np.stack([triangles[rows, longest], triangles[rows, (longest + 1) % 3]], axis=1)
    twice = np.sqrt((np.cross(edges[:, 0], edges[:, 1]) ** 2).sum(axis=1))
    return ends, twice / lengths[rows, longest]


@compiled
def _near(
    ways: Array,
    reach: Array,
    centers: Array,
    radii: Array,
    times: Array,
    starts: Indices,
    ends: Array,
    heights: Array,
    areas: Array,
    doubt: float,
    exactly: float,
) -> Mask:
    found, cones = np.zeros(len(ways), dtype=np.bool_), np.empty(len(centers))
    for i in range(len(ways)):
        around = 0.5 * distance_of_ways(ways[i, 0], ways[i, 0], ways[i, 1], ways[i, 1]) + reach[i]
        share = 0.0
        for k in range(len(centers)):
            square = 0.0
            for axis in range(3):
                square += (0.5 * (ways[i, 0, axis] + ways[i, 1, axis]) - centers[k, axis]) ** 2
            cones[k] = _in_cone(np.sqrt(square) - around, radii[k], times[k])
            share += cones[k]
        if share > doubt:
            share = 0.0
            for k in range(len(centers)):
                if cones[k] > exactly:
                    away = distance_of_ways(ways[i, 0], ways[i, 1], centers[k], centers[k]) - reach[i]
                    rods = _in_rods(ways[i], reach[i], ends, heights, areas, starts[k], starts[k + 1])
                    cones[k] = min(_in_cone(away, radii[k], times[k]), rods, cones[k])
                share += cones[k]
        found[i] = share > doubt
    return found


@compiled
def _in_cone(away: float, radius: float, times: float) -> float:
    """Return the share of all directions in which a ball is, seen from a distance of its middle."""
    return times * 0.5 * (1.0 - np.sqrt(1.0 - (radius / away) ** 2)) if away > radius else np.inf


@compiled
def _in_rods(way: Array, reach: float, ends: Array, heights: Array, areas: Array, start: int, end: int) -> float:
    """Return the share of all directions in which the triangles in some rods are, at most, all along a way."""
    share = 0.0
    for rod in range(start, end):
        away = distance_of_ways(way[0], way[1], ends[rod, 0], ends[rod, 1]) - heights[rod] - reach
        share += areas[rod] / (4.0 * np.pi * away * away) if away > 0.0 else np.inf
    return share


@compiled
def distance_of_ways(start: Array, end: Array, begin: Array, finish: Array) -> float:
    """Return the distance of two straight ways."""
    aa = ab = bb = ac = bc = 0.0
    for k in range(3):
        a, b, c = end[k] - start[k], finish[k] - begin[k], begin[k] - start[k]
        aa, ab, bb, ac, bc = aa + a * a, ab + a * b, bb + b * b, ac + a * c, bc + b * c
    area = aa * bb - ab * ab
    one = min(max((ac * bb - bc * ab) / area, 0.0), 1.0) if area > 0.0 else 0.0
    other = min(max((one * ab - bc) / bb, 0.0), 1.0) if bb > 0.0 else 0.0
    one = min(max((ac + other * ab) / aa, 0.0), 1.0) if aa > 0.0 else 0.0
    square = 0.0
    for k in range(3):
        square += (start[k] + one * (end[k] - start[k]) - begin[k] - other * (finish[k] - begin[k])) ** 2
    return float(np.sqrt(square))
