"""Convex pieces of the hand's links, as the object may touch them.

MuJoCo collides convex solids. A link's collision meshes are replaced by the convex pieces that together contain them,
not by one hull each, which would fill what is hollow. Pieces that a flat pad lies on are cut off a little behind its
face: there the pad is in their place. Of links with curved pads, those pieces are left out that touch the pad's solid.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import product

import numpy as np
from scipy.spatial import ConvexHull

from ..arrays import Array
from ..descriptions import RobotDescription
from ..descriptions.hand import PadDescription
from ..descriptions.urdf import RobotUrdf
from ..geometry.cover_cache import mesh_cover
from ..geometry.mesh_file import meshes_of
from ..kinematics.collision_elements import LinkElement, link_elements
from .pads import is_flat, pad_geom

NEAR = 1e-3
"""Pieces this near to a pad are under it, m."""
_AROUND = 48
"""Corners of the polygon that stands for a circle."""


def link_pieces(
    urdf: RobotUrdf, robot: RobotDescription, links: Iterable[str], pads: Iterable[PadDescription], behind: float
) -> dict[str, list[Array]]:
    """Return the vertices of the convex pieces of some links, each of shape (k, 3), link frame, m.

    Args:
        urdf: of the robot.
        robot: how closely its pieces follow the meshes.
        links: names of links.
        pads: those that touch the object.
        behind: how far behind the face of a flat pad the pieces under it are cut off, m.

    Raises:
        InputError: a collision geometry is not understood, or a mesh cannot be read or has no area.
    """
    pieces: dict[str, list[Array]] = {link: [] for link in links}
    for element in link_elements(urdf, robot.urdf_file):
        if element.link in pieces:
            pieces[element.link] += _of_element(element, robot)
    for pad in pads:
        kept = (_without_pad(vertices, pad, behind) for vertices in pieces[pad.link])
        pieces[pad.link] = [vertices for vertices in kept if vertices is not None]
    return pieces


def _of_element(element: LinkElement, robot: RobotDescription) -> list[Array]:
    if element.mesh is not None:
        with meshes_of(element.link):
            local: Iterable[Array] = mesh_cover(element.mesh, element.size, *robot.collision.of(element.link))
    else:
        local = [_PRIMITIVES[element.kind](*element.size)]
    return [vertices @ element.origin[:3, :3].T + element.origin[:3, 3] for vertices in local]


def _box(*edges: float) -> Array:
    return np.array(list(product((-0.5, 0.5), repeat=3))) * edges


def _cylinder(radius: float, length: float) -> Array:
    angles = np.linspace(0.0, 2 * np.pi, _AROUND, endpoint=False)
    circle = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.concatenate([np.column_stack([circle, np.full(_AROUND, z)]) for z in (-length / 2, length / 2)])


def _sphere(radius: float) -> Array:
    turn = np.arange(_AROUND**2 // 4) + 0.5  # points on a spiral from pole to pole
    z = 1.0 - 2.0 * turn / len(turn)
    angle = np.pi * (1.0 + np.sqrt(5.0)) * turn
    across = np.sqrt(1.0 - z * z)
    return radius * np.column_stack([across * np.cos(angle), across * np.sin(angle), z])


_PRIMITIVES: dict[str, Callable[..., Array]] = {"box": _box, "cylinder": _cylinder, "sphere": _sphere}


def _without_pad(vertices: Array, pad: PadDescription, behind: float) -> Array | None:
    """Return a piece of the pad's link without what would touch in the pad's place; None if nothing is left."""
    patch = pad.patch
    local = (vertices - patch.origin) @ patch.rotation
    if not _under(local, pad):
        return vertices
    left = _cut(local, -behind) if is_flat(pad) else None
    return None if left is None else np.asarray(left @ patch.rotation.T + patch.origin)


def _under(local: Array, pad: PadDescription) -> bool:
    """Whether a piece, in the frame of the patch, comes near to the pad's solid."""
    geom = pad_geom(pad)
    half = {"box": geom.size, "sphere": geom.size * 3, "cylinder": (geom.size[0], geom.size[0], geom.size[-1])}
    # Points all over the solid's bounding box: some lie in a piece that lies under the pad.
    ticks = np.linspace(-1.0, 1.0, 9)
    points = np.array(list(product(ticks, repeat=3))) * half[geom.kind] @ geom.rotation.T + geom.center
    planes = ConvexHull(local).equations
    return bool((points @ planes[:, :3].T + planes[:, 3]).max(axis=1).min() <= NEAR)


def _cut(vertices: Array, height: float) -> Array | None:
    """Return the part of a convex piece below a height along z, or None if it has no volume."""
    below = vertices[:, 2] <= height
    if below.all():
        return vertices
    hull = ConvexHull(vertices)
    edges = {tuple(sorted(pair)) for a, b, c in hull.simplices.tolist() for pair in ((a, b), (b, c), (c, a))}
    points = [vertices[below]]
    for one, other in sorted(edges):
        if below[one] != below[other]:
            along = (height - vertices[one, 2]) / (vertices[other, 2] - vertices[one, 2])
            points.append((vertices[one] + along * (vertices[other] - vertices[one]))[None])
    part = np.concatenate(points)
    thick = len(part) > 3 and height - part[:, 2].min() > NEAR / 10
    return part[ConvexHull(part).vertices] if thick else None
