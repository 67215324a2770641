"""Shapes filled evenly: for the centre of mass of an object that gives none."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Compound, FormulaShape, Mesh, ShapeDescription
from ..filled import Filled, counted_again
from ..object_mesh import object_mesh
from .core import Geometry


@lru_cache(maxsize=64)  # a planner asks again whenever the object is moved
def filled(shape: ShapeDescription, geometry_of: Callable[[ShapeDescription], Geometry]) -> Filled:
    """Return the integrals over a shape; what parts share counts once.

    Args:
        shape: described.
        geometry_of: gives the geometry of a part.
    """
    if isinstance(shape, Mesh):
        return object_mesh(shape).filled
    if isinstance(shape, Compound):
        return _filled_compound(shape, geometry_of)
    assert isinstance(shape, FormulaShape)
    return Filled(shape.volume, shape.volume * np.array(shape.centroid))


def _filled_compound(shape: Compound, geometry_of: Callable[[ShapeDescription], Geometry]) -> Filled:
    poses = [part.pose.matrix for part in shape.parts]
    each = [filled(part.shape, geometry_of).placed(T) for part, T in zip(shape.parts, poses, strict=True)]
    whole = Filled(sum(of.volume for of in each), np.sum([of.moment for of in each], axis=0))
    if len(each) == 1:
        return whole
    geometries = [geometry_of(part.shape) for part in shape.parts]
    balls = [
        (T[:3, :3] @ of.middle + T[:3, 3], of.radius_about(of.middle)) for of, T in zip(geometries, poses, strict=True)
    ]

    def count(points: Array) -> Array:
        inside = np.zeros(len(points))
        for of, T in zip(geometries, poses, strict=True):
            inside += of.distances((points - T[:3, 3]) @ T[:3, :3]) <= 0.0
        return inside

    low = np.min([center - radius for center, radius in balls], axis=0)
    high = np.max([center + radius for center, radius in balls], axis=0)
    return whole.less(counted_again(count, low, high))
