"""Triangles that stand for a surface where it is drawn."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array, Indices


class Tessellation(NamedTuple):
    """Triangles of a closed surface."""

    vertices: Array
    """Shape (n, 3), m."""
    triangles: Indices
    """Three vertices each, counterclockwise seen from outside, shape (m, 3)."""

    @property
    def corners(self) -> Array:
        """The vertices of every triangle, shape (m, 3, 3), m."""
        return np.asarray(self.vertices[self.triangles])


def tessellation_of(mesh: Any) -> Tessellation:
    """Return the triangles of a trimesh.Trimesh."""
    return Tessellation(np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.intp))


def refined(tessellation: Tessellation, longest: float) -> Tessellation:
    """Return the same flat facets in smaller triangles.

    Triangles are halved at their longest edge until it is short enough. An edge is only ever cut at its middle, and
    by both of its triangles, so that no gaps open.

    Args:
        tessellation: triangles.
        longest: greatest length of an edge, m.
    """
    whole = _longest_edges(tessellation.corners) <= longest
    finished, corners = [np.zeros((0, 3, 3))], tessellation.corners[~whole]
    while len(corners):
        edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)  # from each corner to the next
        short = edges.max(axis=1) <= longest
        finished.append(corners[short])
        order = (edges[~short].argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(corners[~short], order[:, :, None], axis=1).transpose(1, 0, 2)
        middle = (a + b) / 2
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    count = len(tessellation.vertices)
    places = np.concatenate([tessellation.vertices, np.concatenate(finished).reshape(-1, 3)])
    vertices, joined = np.unique(places, axis=0, return_inverse=True)
    joined = joined.reshape(-1)
    return Tessellation(
        vertices, np.concatenate([joined[tessellation.triangles[whole]], joined[count:].reshape(-1, 3)])
    )


def _longest_edges(corners: Array) -> Array:
    """Return the length of the longest edge of triangles, shape (n, 3, 3), m, shape (n,)."""
    return np.asarray(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1))
