"""Bodies that Coal measures, made from arrays."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from ..arrays import Array, Integers

_FACES = 150
"""Faces of a polyhedron around a hull, besides those of its box: none has a corner with too many neighbours."""


def triangle_tree(vertices: Array, faces: Integers) -> Any:
    """Return a tree of triangles: it has distances of what is apart, no depths and no inside.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(faces), len(vertices))
    tree.addVertices(vertices)
    tree.addTriangles(faces)
    tree.endModel()
    tree.computeLocalAABB()
    return tree


def hull_corners(points: Array) -> Array:
    """Return the corners of the convex hull of points, shape (n, 3); all of them where they are flat."""
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points


def hull_solid(points: Array) -> Any | None:
    """Return the convex hull of points, shape (n, 3), all of which are corners of it; None where they are flat.

    Where one of them has more neighbours than Coal takes, it is a polyhedron around the hull: some of its faces, and of
    its box. So a distance to it is never more than that to the hull.
    """
    try:
        hull = ConvexHull(points)
        try:
            return _solid(points, hull.simplices)
        except RuntimeError:
            corners = _corners_of_some_faces(hull)
            return _solid(corners, ConvexHull(corners).simplices)
    except (QhullError, RuntimeError):
        return None


def _solid(points: Array, simplices: Integers) -> Any:
    corners, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for triangle in simplices.tolist():
        triangles.append(coal.Triangle(*triangle))
    corners.extend(points)
    return coal.Convex(corners, triangles)


def _corners_of_some_faces(hull: Any) -> Array:
    """Return the corners of what is behind the faces of a hull that look most nearly along random directions."""
    along = np.random.default_rng(0).standard_normal((_FACES, 3))
    faces = hull.equations[np.unique((hull.equations[:, :3] @ along.T).argmax(axis=0))]
    box = np.column_stack([np.vstack([np.eye(3), -np.eye(3)]), [*-hull.max_bound, *hull.min_bound]])
    middle = hull.points[hull.vertices].mean(axis=0)
    corners = HalfspaceIntersection(np.vstack([faces, box]), middle).intersections
    return np.unique(corners[np.isfinite(corners).all(axis=1)], axis=0)
