"""How deep an object to which pads yield, a mesh, is pressed into their rubber.

Rubber that yields by `rubber_depth` is taken to be twice as thick: it is what of a pad's link is flush with the pad, or
less than that behind it, its sides included. The depth of the object in it is the largest depth in the object of points
all over the pad's face and that part of the link, by exact distances, and is to be at most `rubber_depth` + `SLACK`.
The rest of the link, its backing, does not yield: the object may not enter it at all. It does so if the triangles of
both cross, if one surrounds the other, or if a vertex of the object is inside the link behind the rubber: of what dips
in through the rubber without crossing a side of the backing, the lowest point is a vertex.

A link with several pads yields at each of them, so that its backing is behind all of them. What stands out beside a
pad is a link like any other (`standing_out`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.spatial import ConvexHull, KDTree, QhullError

from ..arrays import Array, Indices, Integers
from ..descriptions.hand import PadDescription
from ..descriptions.patches import CylinderPatch, Patch, SpherePatch
from ..memo import remembered
from .certificate import Figure, PairClearance
from .clearance import CAP, Placed, part_distance
from .link_mesh import LinkMesh
from .outlines import points_of
from .patches import heights
from .robot import VerifiedRobot
from .shapes import PlacedShape
from .shapes.core import PENETRATION

SLACK = 3e-4
"""How much deeper than the rubber's depth the object may be pressed in, m."""
SPACING = 5e-4
"""Of the points on rubber, m."""
COARSE = 2e-3
"""Of those that are looked at first, m."""
_ROUNDING = 1e-9
_FACET = 1e-3
"""Longest edge of the triangles into which a link with a curved pad is divided, m."""


@dataclass(frozen=True)
class Skin:
    """The surface of rubber as points, link frame; a signed distance changes by no more than the way between two."""

    coarse: Array
    """Some of the points, about `COARSE` apart, m, shape (c, 3)."""
    fine: Array
    """All points, at most about `SPACING` apart, m, shape (n, 3)."""
    nearest: Indices
    """Number of the coarse point that is nearest to each, shape (n,)."""
    away: Array
    """How far that is, m, shape (n,)."""

    @classmethod
    def of(cls, pad: PadDescription, mesh: LinkMesh) -> Skin:
        """Put points on a pad and on what of its link is no farther behind it than rubber is thick."""
        face = points_of(pad.patch, SPACING) @ pad.patch.rotation.T + pad.patch.origin
        vertices, faces = _before(pad.patch, mesh.vertices, mesh.faces, -_thickness(pad))
        if len(faces):
            vertices, faces = trimesh.remesh.subdivide_to_size(vertices, faces, SPACING, max_iter=20)
            vertices = vertices[np.unique(faces)]
            vertices = vertices[heights(pad.patch, vertices) <= PENETRATION]  # what stands out is another matter
            face = np.vstack([face, _thinned(vertices, SPACING)])
        coarse = _thinned(face, COARSE)
        away, nearest = KDTree(coarse).query(face)
        return cls(coarse, face, nearest, away)

    def least(self, distances: Callable[[Array, float], Array]) -> float:
        """Return the least signed distance of the points, m.

        Args:
            distances: signed distances of points, link frame, shape (n, 3), that count if they are below a limit, m.
        """
        found = distances(self.coarse, math.inf)
        least = float(found.min())
        closer = self.fine[found[self.nearest] - self.away < least]
        return min(least, float(distances(closer, least).min(initial=math.inf)))


@dataclass(frozen=True)
class PadLink:
    """A link with pads, link frame."""

    mesh: LinkMesh
    pads: tuple[PadDescription, ...]
    """On this link."""
    skins: tuple[Skin, ...]
    """Of the rubber of these pads."""
    backing: LinkMesh | None
    """What of the link is behind all rubber, cut open; None: nothing."""
    lid: LinkMesh | None
    """Convex polygon that closes a backing which is cut by one plane; None: there is none."""

    @classmethod
    def of(cls, mesh: LinkMesh, pads: tuple[PadDescription, ...]) -> PadLink:
        """Divide a link."""
        backing = _backing(mesh, pads)
        lid = None if backing is None or len(pads) > 1 else _lid(backing, pads[0])
        return cls(mesh, pads, tuple(Skin.of(pad, mesh) for pad in pads), backing, lid)


@remembered
def pad_links(robot: VerifiedRobot, pads: tuple[PadDescription, ...]) -> tuple[PadLink, ...]:
    """Return the links with pads.

    Args:
        robot: its meshes.
        pads: those of the task.
    """
    on = {link: tuple(pad for pad in pads if pad.link == link) for link in robot.meshes}
    return tuple(PadLink.of(mesh, on[link]) for link, mesh in robot.meshes.items() if on[link])


def rubber_figure(links: tuple[PadLink, ...], target: PlacedShape, placed: Placed) -> Figure:
    """Return the least signed distance, m, of a pad's rubber to the object; -inf if the object enters a backing.

    That of the pad which is nearest to its limit, for pads may differ in depth.
    """
    found = [pair for link in links for pair in _distances(link, target, placed)]
    pad, distance = min(found, key=lambda pair: pair[1] - _limit(pair[0]))
    return Figure("pad clearance", distance, _limit(pad), "m", "at least", f"{pad.link} / {target.name}")


def rubber_clearances(links: tuple[PadLink, ...], target: PlacedShape, placed: Placed) -> Iterator[PairClearance]:
    """Yield the signed distances of pads' links to the object, as in `rubber_figure`, that are below `CAP`."""
    for link in links:
        distance = min(distance for _, distance in _distances(link, target, placed))
        if distance < CAP:
            yield PairClearance("pad clearance", link.mesh.link, target.name, distance)


def _distances(link: PadLink, target: PlacedShape, placed: Placed) -> list[tuple[PadDescription, float]]:
    """Return the signed distance of each pad of a link, m."""
    if _entered(link, target, placed):
        return [(pad, -math.inf) for pad in link.pads]

    def distances(points: Array, below: float) -> Array:
        return target.distances(placed.to_world(link.mesh.link, points), below)

    return [(pad, skin.least(distances)) for pad, skin in zip(link.pads, link.skins, strict=True)]


def _entered(link: PadLink, target: PlacedShape, placed: Placed) -> bool:
    """Whether the object enters a link behind its rubber."""
    if link.backing is None:
        return False
    for part in target.parts:
        if part_distance(link.backing, part, placed, SLACK) <= 0.0:
            return True
        if link.lid is not None and part_distance(link.lid, part, placed, SLACK) > 0.0:
            continue
        vertices = placed.to_link(link.mesh.link, part.vertices)
        behind = np.all([heights(pad.patch, vertices) < -_thickness(pad) for pad in link.pads], axis=0)
        if link.mesh.surrounds(vertices[behind]):
            return True
    return False


def _limit(pad: PadDescription) -> float:
    return -(pad.rubber_depth + SLACK)


def _thinned(points: Array, spacing: float) -> Array:
    """Return one of the points, shape (n, 3), in every cube with edges of a length, m."""
    return np.asarray(points[np.unique(np.round(points / spacing), axis=0, return_index=True)[1]])


def _thickness(pad: PadDescription) -> float:
    return 2.0 * pad.rubber_depth


def _backing(mesh: LinkMesh, pads: tuple[PadDescription, ...]) -> LinkMesh | None:
    vertices, faces = mesh.vertices, mesh.faces
    for pad in pads:
        vertices, faces = _behind(pad.patch, vertices, faces, -_thickness(pad))
        if not len(faces):
            return None
    return mesh.opened(vertices, faces)


def _lid(backing: LinkMesh, pad: PadDescription) -> LinkMesh | None:
    """Return the convex hull of where a backing is cut by the plane behind a flat pad."""
    if isinstance(pad.patch, CylinderPatch | SpherePatch):
        return None
    rim = backing.vertices[heights(pad.patch, backing.vertices) > -_thickness(pad) - _ROUNDING]
    try:
        polygon = rim[ConvexHull(rim @ pad.patch.rotation[:, :2]).vertices]
    except (QhullError, ValueError):  # nothing was cut, or a line
        return None
    count = np.arange(len(polygon) - 2)
    return backing.opened(polygon, np.column_stack([np.zeros_like(count), count + 1, count + 2]))


def _behind(patch: Patch, vertices: Array, faces: Integers, height: float) -> tuple[Array, Integers]:
    """Return what of triangles is lower than a height over a patch; of a curved one whole small triangles."""
    if isinstance(patch, CylinderPatch | SpherePatch):
        vertices, faces = trimesh.remesh.subdivide_to_size(vertices, faces, _FACET, max_iter=20)
        return vertices, faces[(heights(patch, vertices) < height)[faces].all(axis=1)]
    return _sliced(patch, vertices, faces, height, -1.0)


def _before(patch: Patch, vertices: Array, faces: Integers, height: float) -> tuple[Array, Integers]:
    """Return what of triangles is higher than a height over a patch; of a curved one whole small triangles."""
    if isinstance(patch, CylinderPatch | SpherePatch):
        vertices, faces = trimesh.remesh.subdivide_to_size(vertices, faces, _FACET, max_iter=20)
        return vertices, faces[(heights(patch, vertices) > height)[faces].all(axis=1)]
    return _sliced(patch, vertices, faces, height, 1.0)


def _sliced(patch: Patch, vertices: Array, faces: Integers, height: float, side: float) -> tuple[Array, Integers]:
    normal = patch.rotation[:, 2]
    origin = np.array(patch.origin) + height * normal
    found = trimesh.intersections.slice_faces_plane(vertices, faces, side * normal, origin)
    return np.asarray(found[0]), np.asarray(found[1])
