"""Overlaps of two bodies of a scene, and gaps between them."""

from __future__ import annotations

from itertools import product

import coal
import numpy as np

from ..arrays import Array
from ..collision.solids import distance_request, scene_body
from ..descriptions.bodies import Body
from ..descriptions.shapes import ShapeDescription
from ..geometry.shapes import surface_of
from ..geometry.tessellation import refined
from ..memo import remembered

APART = 0.004
"""Longest edge of triangles at whose corners a mesh and another body are looked at for overlaps, m."""


def depth_in(first: Body, second: Body) -> float:
    """Return how far one body must be moved to be clear of the other, m; negative: their distance, or less."""
    surfaces = [surface_of(body.shape) for body in (first, second)]
    apart = np.linalg.norm(first.pose.matrix[:3, 3] - second.pose.matrix[:3, 3]) - sum(s.radius for s in surfaces)
    if apart > 0.0:
        return -float(apart)
    if any(surface.uneven for surface in surfaces):
        return max(_points_inside(first, second), _points_inside(second, first))
    request = distance_request()
    distances = []
    one, two = scene_body("target", "", first), scene_body("obstacle", "", second)
    for a, b in product(one.solids, two.solids):
        poses = [coal.Transform3s(T[:3, :3], T[:3, 3]) for T in (one.pose @ a.placement, two.pose @ b.placement)]
        distances.append(coal.distance(a.shape, poses[0], b.shape, poses[1], request, coal.DistanceResult()))
    return -float(min(distances))


def _points_inside(first: Body, second: Body) -> float:
    """Return how deep points on one body are in the other, m; negative: how far they are from it."""
    points = _points_on(first.shape)
    T = np.linalg.inv(second.pose.matrix) @ first.pose.matrix
    return -float(surface_of(second.shape).signed_distance(points @ T[:3, :3].T + T[:3, 3])[0].min())


@remembered
def _points_on(shape: ShapeDescription) -> Array:
    return refined(surface_of(shape).tessellation(), APART).vertices
