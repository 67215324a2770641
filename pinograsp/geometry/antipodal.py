"""Pairs of opposite points of a surface: where two pads that face each other can touch it.

One point of a pair is drawn by area. A ray along the inward normal there leads through the body to the other one: where
it leaves the body for the first time, or for the last. That one then slides to where its normal is the opposite one, as
far as the surface bends: on a ball it is there already, on an ellipsoid it goes to the other end of the diameter, on a
flat face it stays. Normals are those that a pad feels.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices
from .shapes import Surface
from .tessellation import Tessellation

BEGIN = 1e-4
"""How far below the surface a ray begins, m."""
LEAST_STEP = 2e-4
"""Steps of a ray are no shorter than this, m: thinner gaps in a body are overlooked."""
LONGEST_RAY = 2.1
"""In radii of the ball that contains the body."""
HALVINGS = 20
"""Of the step in which a ray leaves the body."""
SLIDES = 8
"""Steps in which the second point slides."""
LONGEST_SLIDE = 0.01
"""Of one step, m."""
FLAT, FLAT_SHARE = 1.0, 1e-5
"""Curvature below which a surface counts as flat, 1/m, and share of its greatest one there."""


class Pairs(NamedTuple):
    """Pairs of points of a surface, shape's frame."""

    points: Array
    """m, shape (n, 2, 3)."""
    normals: Array
    """Outward unit normals there, shape (n, 2, 3)."""

    def at(self, indices: Indices) -> Pairs:
        """Return some of the pairs."""
        return Pairs(self.points[indices], self.normals[indices])

    @property
    def widths(self) -> Array:
        """Distance of the points along the first normal, m, shape (n,)."""
        return np.asarray(((self.points[:, 0] - self.points[:, 1]) * self.normals[:, 0]).sum(axis=1))

    @property
    def tilts(self) -> Array:
        """Angles between the first normal and the opposite of the second, rad, shape (n,)."""
        sums = np.linalg.norm(self.normals.sum(axis=1), axis=1)
        return np.asarray(2.0 * np.arcsin(np.clip(0.5 * sums, 0.0, 1.0)))

    @property
    def leans(self) -> Array:
        """Angles of both normals to the line through the points, rad, shape (n, 2)."""
        across = self.points[:, 0] - self.points[:, 1]
        lengths = np.linalg.norm(across, axis=1)
        along = across / np.where(lengths > 0.0, lengths, 1.0)[:, None]
        cosines = (self.normals * np.stack([along, -along], axis=1)).sum(axis=2)
        return np.asarray(np.arccos(np.clip(cosines, -1.0, 1.0)))


def opposite_points(surface: Surface, count: int, rng: np.random.Generator) -> Pairs:
    """Return pairs whose first points are spread over a surface by area; up to two for each.

    Args:
        surface: closed.
        count: number of points that are drawn.
        rng: what is drawn from.
    """
    first = _on_surface(surface, drawn(surface.tessellation(), count, rng))
    normals = surface.footprint(first)[0]
    second, rays = _through(surface, first, -normals)
    first, normals = first[rays], normals[rays]
    second = _slid(surface, second, -normals)
    return Pairs(np.stack([first, second], axis=1), np.stack([normals, surface.footprint(second)[0]], axis=1))


def drawn(tessellation: Tessellation, count: int, rng: np.random.Generator) -> Array:
    """Return points on triangles, drawn by area, m, shape (count, 3)."""
    a, b, c = tessellation.corners.transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chosen = rng.choice(len(areas), count, p=areas / areas.sum())
    u, v = rng.uniform(size=(2, count))
    u, v = np.where(u + v > 1.0, (1.0 - u, 1.0 - v), (u, v))
    a, b, c = a[chosen], b[chosen], c[chosen]
    return np.asarray(a + u[:, None] * (b - a) + v[:, None] * (c - a))


def _on_surface(surface: Surface, points: Array) -> Array:
    """Return points near a surface moved onto it."""
    for _ in range(2):
        distances, gradients, _ = surface.signed_distance(points)
        points = points - distances[:, None] * gradients
    return points


def _through(surface: Surface, points: Array, inward: Array) -> tuple[Array, Indices]:
    """Return where rays from points leave the body, first and last, shape (m, 3), and the ray of each, shape (m,).

    Through the wall of a mug, and through both of its walls and what is between them.
    """
    at, was_inside = np.full(len(points), BEGIN), np.ones(len(points), dtype=bool)
    brackets = np.full((2, 2, len(points)), np.nan)  # of the first and of the last way out: before it and after it
    going = np.arange(len(points))
    distances = _along(surface, points, inward, at)
    while len(going):
        further = at[going] + np.maximum(np.abs(distances), LEAST_STEP)
        distances = _along(surface, points[going], inward[going], further)
        out = was_inside[going] & (distances >= 0.0)
        brackets[1][:, going[out]] = at[going[out]], further[out]
        first = going[out & np.isnan(brackets[0, 0, going])]
        brackets[0][:, first] = brackets[1][:, first]
        at[going], was_inside[going] = further, distances < 0.0
        left = further < LONGEST_RAY * surface.radius
        going, distances = going[left], distances[left]
    second = brackets[1, 0] > brackets[0, 0]  # not where there is one way out
    rays = np.concatenate([np.flatnonzero(~np.isnan(brackets[0, 0])), np.flatnonzero(second)])
    inside, beyond = np.concatenate([brackets[0][:, ~np.isnan(brackets[0, 0])], brackets[1][:, second]], axis=1)
    for _ in range(HALVINGS):
        middle = 0.5 * (inside + beyond)
        out = _along(surface, points[rays], inward[rays], middle) >= 0.0
        inside, beyond = np.where(out, inside, middle), np.where(out, middle, beyond)
    return points[rays] + inside[:, None] * inward[rays], rays


def _along(surface: Surface, points: Array, directions: Array, lengths: Array) -> Array:
    """Return the signed distances of points on rays, m, shape (n,)."""
    return surface.signed_distance(points + lengths[:, None] * directions)[0]


def _slid(surface: Surface, points: Array, wanted: Array) -> Array:
    """Return points that have slid over a surface to where its normals are those wanted, as far as it bends."""
    points = _on_surface(surface, points)
    for _ in range(SLIDES):
        normals, slopes = surface.footprint(points)
        squares = slopes.transpose(0, 2, 1) @ slopes
        flat = FLAT**2 + FLAT_SHARE**2 * np.trace(squares, axis1=1, axis2=2)
        squares += flat[:, None, None] * np.eye(3)
        slides = np.linalg.solve(squares, slopes.transpose(0, 2, 1) @ (wanted - normals)[:, :, None])[:, :, 0]
        lengths = np.linalg.norm(slides, axis=1)[:, None]
        slides *= np.minimum(1.0, LONGEST_SLIDE / np.maximum(lengths, LONGEST_SLIDE))
        points = _on_surface(surface, points + slides)
    return points
