"""Symbols composed from meshcat's primitives: balls, arrows, friction cones, edges; lengths in m.

meshcat's cylinder is centred at its origin, its axis is y: a cylinder with one zero radius is a cone.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any

import numpy as np

from ..arrays import Array
from .viewer import LayeredMesh, Visualizer, geometry

HEAD_LENGTH = 6.0
"""Length of an arrow's head in radii of its shaft."""
HEAD_RADIUS = 2.4
"""Radius of an arrow's head in radii of its shaft."""


@dataclass(frozen=True)
class Piece:
    """One meshcat geometry and its pose."""

    geometry: Any
    T: Array
    """Pose of the geometry in the frame that it is drawn in, shape (4, 4)."""


@dataclass(frozen=True)
class Look:
    """Colour of a piece and how it lies over the others."""

    color: int
    """0xrrggbb."""
    opacity: float = 1.0
    layer: int | None = None
    """Pieces with a layer are painted after those without, greater over less, unless something solid that
    stands in front hides them: so a symbol inside a glass object in a glass box keeps its colour."""


def translation(p: Iterable[float]) -> Array:
    """Return the pose at p, shape (3,), without rotation; shape (4, 4)."""
    T = np.eye(4)
    T[:3, 3] = np.asarray(p)
    return T


def between(start: Array, end: Array) -> Array:
    """Return the pose, shape (4, 4), midway between two points, its y axis from `start` to `end`."""
    y = (end - start) / np.linalg.norm(end - start)
    x = np.cross(y, np.eye(3)[np.argmin(np.abs(y))])
    x /= np.linalg.norm(x)
    T = translation((start + end) / 2)
    T[:3, :3] = np.column_stack([x, y, np.cross(x, y)])
    return T


def ball(center: Array, radius: float) -> Piece:
    """Return a ball around `center`, shape (3,)."""
    return Piece(geometry.Sphere(radius), translation(center))


def frustum(start: Array, end: Array, start_radius: float, end_radius: float) -> Piece:
    """Return a round bar from `start` to `end`, shapes (3,); a zero radius makes it a cone."""
    height = float(np.linalg.norm(end - start))
    bar = geometry.Cylinder(height, radiusTop=float(end_radius), radiusBottom=float(start_radius))
    return Piece(bar, between(start, end))


def arrow(tail: Array, tip: Array, radius: float) -> dict[str, Piece]:
    """Return the shaft and the head of an arrow whose point is exactly at `tip`; `radius` of the shaft."""
    length = float(np.linalg.norm(tip - tail))
    neck = tip - (tip - tail) * min(HEAD_LENGTH * radius / length, 0.6)
    return {
        "shaft": frustum(tail, neck, radius, radius),
        "head": frustum(neck, tip, HEAD_RADIUS * radius, 0.0),
    }


def friction_cone(apex: Array, axis: Array, mu: float, height: float) -> Piece:
    """Return the cone of half-angle atan(mu) that opens from `apex` along the unit vector `axis`."""
    return frustum(apex, apex + height * axis, 0.0, mu * height)


def box(low: Array, high: Array) -> Piece:
    """Return the box with edges along the axes between two corners, shapes (3,)."""
    return Piece(geometry.Box([float(length) for length in high - low]), translation((low + high) / 2))


def box_edges(low: Array, high: Array, radius: float) -> dict[str, Piece]:
    """Return the twelve edges of the box between two corners as thin round bars, by their corners."""
    corners = list(product((0, 1), repeat=3))
    edges: dict[str, Piece] = {}
    for one, other in combinations(corners, 2):
        if sum(a != b for a, b in zip(one, other, strict=True)) == 1:
            start, end = (np.where(corner, high, low).astype(np.float64) for corner in (one, other))
            edges["".join(map(str, one + other))] = frustum(start, end, radius, radius)
    return edges


def draw(node: Visualizer, piece: Piece, look: Look) -> None:
    """Draw one piece at a node of the viewer's tree."""
    material = geometry.MeshPhongMaterial(
        color=look.color,
        opacity=look.opacity,
        transparent=look.layer is not None,
        depthWrite=look.opacity == 1.0,  # what is see-through hides nothing behind it
    )
    node.set_object(LayeredMesh(piece.geometry, material, look.layer or 0))
    node.set_transform(piece.T)
