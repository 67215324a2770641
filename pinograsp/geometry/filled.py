"""Bodies filled evenly: their centre of mass and volume. What several parts share counts once.

Let m(p) be how many times a point is enclosed: the winding number of a mesh, the number of parts of a compound that
hold it. Sums over tetrahedra, or over parts, are integrals of m. The body is where m > 1/2, so that

    integral over the body  =  integral of m  -  integral of s,      s = m - 1 where m > 1/2, else m

Where nothing overlaps s is zero, and the sums are exact. Elsewhere the integral of s is a mean over the points of a
Sobol sequence, in the box in which fewer of them, in the box around the body, found it. The centre errs by some
micrometres.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

from ..arrays import Array
from ..descriptions.bodies import Object
from ..descriptions.shapes import Compound, FormulaShape, Mesh, ShapeDescription
from ..frozen import frozen
from .object_mesh import object_mesh
from .shapes import surface_of
from .winding import Winding

SAMPLES, FIRST = 1 << 17, 1 << 15
"""Points at which it is counted how many times they are enclosed, and those that tell where that is more than once."""


class Filled(NamedTuple):
    """A body filled evenly, in its own frame."""

    centroid: Array
    """Centre of mass, m, shape (3,)."""
    volume: float
    """m^3."""


def center_of_mass(body: Object) -> Array:
    """Return where the centre of mass of an object is in its frame, m, shape (3,); read-only.

    Raises:
        FileError: none is given, and the file of a mesh cannot be read, has changed or encloses no body.
    """
    given = body.center_of_mass
    return np.asarray(frozen(filled(body.shape).centroid if given is None else np.array(given)))


def center_of_mass_world(body: Object) -> Array:
    """Return where the centre of mass of an object is in the world, m, shape (3,); errors as of `center_of_mass`."""
    T = body.pose.matrix
    return np.asarray(T[:3, :3] @ center_of_mass(body) + T[:3, 3])


@lru_cache(maxsize=64)
def filled(shape: ShapeDescription) -> Filled:
    """Return the centre of mass and the volume of a shape.

    Raises:
        FileError: the file of a mesh cannot be read, has changed since it was described, or encloses no body.
    """
    if isinstance(shape, Mesh):
        return _filled_mesh(shape)
    if isinstance(shape, Compound):
        return _filled_compound(shape)
    assert isinstance(shape, FormulaShape)
    return Filled(np.array(shape.centroid), shape.volume)


def _filled_mesh(shape: Mesh) -> Filled:
    body = object_mesh(shape)
    low, high = body.vertices.min(axis=0), body.vertices.max(axis=0)
    middle = 0.5 * (low + high)
    a, b, c = (body.triangles - middle).transpose(1, 0, 2)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    whole = float(volumes.sum()), 0.25 * (volumes @ (a + b + c)) + volumes.sum() * middle
    if body.outer.all():
        return Filled(whole[1] / whole[0], whole[0])
    winding = Winding(body.vertices, body.faces)
    return _without(*whole, *_surplus(lambda points: np.rint(winding.numbers(points)), low, high))


def _filled_compound(shape: Compound) -> Filled:
    each = [filled(part.shape) for part in shape.parts]
    poses = [part.pose.matrix for part in shape.parts]
    volume = sum(part.volume for part in each)
    moment = np.zeros(3)
    for part, T in zip(each, poses, strict=True):
        moment += part.volume * (T[:3, :3] @ part.centroid + T[:3, 3])
    surfaces = [surface_of(part.shape) for part in shape.parts]
    if len(surfaces) == 1:
        return Filled(moment / volume, volume)

    def count(points: Array) -> Array:
        inside = np.zeros(len(points))
        for surface, T in zip(surfaces, poses, strict=True):
            inside += surface.exact_distances((points - T[:3, 3]) @ T[:3, :3]) <= 0.0
        return inside

    whole, axes = surface_of(shape), np.eye(3)
    high = np.array([whole.extent(axis) for axis in axes])
    low = np.array([-whole.extent(-axis) for axis in axes])
    return _without(volume, moment, *_surplus(count, low, high))


def _surplus(count: Callable[[Array], Array], low: Array, high: Array) -> tuple[float, Array]:
    """Return the integrals of s and s p over a box from `low` to `high`, m^3 and m^4.

    Args:
        count: gives m at points, shape (n, 3), shape (n,).
        low: shape (3,), m.
        high: likewise.
    """
    shares = qmc.Sobol(3, scramble=False).random(SAMPLES)

    def surplus(points: Array) -> Array:
        many = count(points)
        return np.asarray(many - (many > 0.5))

    some = low + (high - low) * shares[:FIRST]
    where = some[surplus(some) != 0.0]
    if not len(where):
        return 0.0, np.zeros(3)
    between = 2.0 * (high - low) / FIRST ** (1.0 / 3.0)
    low, high = np.maximum(where.min(axis=0) - between, low), np.minimum(where.max(axis=0) + between, high)
    points = low + (high - low) * shares
    found = surplus(points) * float(np.prod(high - low)) / SAMPLES
    return float(found.sum()), found @ points


def _without(volume: float, moment: Array, surplus: float, surplus_moment: Array) -> Filled:
    return Filled((moment - surplus_moment) / (volume - surplus), volume - surplus)
