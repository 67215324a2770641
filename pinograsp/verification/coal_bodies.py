"""Bodies that Coal measures, made from arrays."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ..arrays import Array, Integers


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
    """Return the convex hull of points, shape (n, 3), all of which are corners of it.

    None where Qhull or Coal makes none: flat, or a corner with hundreds of neighbours.
    """
    corners, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    try:
        for triangle in ConvexHull(points).simplices.tolist():
            triangles.append(coal.Triangle(*triangle))
        corners.extend(points)
        return coal.Convex(corners, triangles)
    except (QhullError, RuntimeError):
        return None
