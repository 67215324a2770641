"""Interface of the shapes: their geometry, and the bodies within them that Coal measures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from ...arrays import Array

PENETRATION = 2e-5
"""How deep a link may stick in the object, m: 0.02 mm."""


@dataclass(frozen=True)
class Core:
    """A body inside the shape: the shape without everything nearer than `inset` (m) to its surface."""

    solid: Any
    """Coal geometry, centred like the shape."""
    inset: float


class Geometry(Protocol):
    """A shape in its own frame; points have shape (3,), metres.

    `cores` are tried in turn until one is clear of a mesh: Coal measures meshes only when they are apart.
    """

    cores: tuple[Core, ...]

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface, negative inside."""

    def inward(self, point: Array) -> Array:
        """Inward unit normal of the surface at its point nearest to `point`."""

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""

    def face(self, point: Array) -> Array:
        """Part of the surface in the tangent plane at the surface point nearest to `point`.

        A point, the ends of a line, or the corners of a convex polygon in order, shape (k, 3).
        """

    def edge(self, point: Array) -> float:
        """Distance of `point` from the edges of the face that it lies on; inf if the face has none."""
