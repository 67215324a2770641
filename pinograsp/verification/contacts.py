"""Figures of the contacts: points on the object and on the pads, pads tangent to the object, footprints in regions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..descriptions.hand import PadDescription
from ..descriptions.mesh_contact import LARGEST_TILT
from ..descriptions.regions import Region
from .certificate import Figure
from .kinematics import Poses
from .outlines import Rubber, half_sides, rubber_at
from .patches import contact_face, nearest_on_patch, rim_distance
from .regions import depths
from .shapes import PlacedShape

REGION_TOLERANCE = 1e-9
"""How far a contact point may be outside its region, m."""
FOOTPRINT_TOLERANCE = 1e-6
"""How far a footprint may reach outside its region, m."""
RIM_TOLERANCE = 2e-6
"""How far a contact point may be beyond the rim of its pad, m."""
EDGE_TOLERANCE = 2e-5
"""How far a contact point may be beyond the edge of the object's face, m."""


@dataclass(frozen=True)
class Pads:
    """The pads at the link poses of one claim, world frame."""

    pads: tuple[PadDescription, ...]
    origins: Array
    """Shape (pads, 3), m."""
    rotations: Array
    """Shape (pads, 3, 3); columns x, y, outward normal."""

    @classmethod
    def at(cls, pads: Sequence[PadDescription], poses: Poses) -> Pads:
        """Place pads."""
        links = [poses[pad.link] for pad in pads]
        return cls(
            pads=tuple(pads),
            origins=np.array([T[:3, :3] @ pad.patch.origin + T[:3, 3] for T, pad in zip(links, pads, strict=True)]),
            rotations=np.array([T[:3, :3] @ pad.patch.rotation for T, pad in zip(links, pads, strict=True)]),
        )

    @property
    def names(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(pad.name for pad in self.pads)

    @property
    def poses(self) -> Array:
        """Poses of the patch frames in the world, m, shape (pads, 4, 4)."""
        T = np.tile(np.eye(4), (len(self.pads), 1, 1))
        T[:, :3, :3], T[:, :3, 3] = self.rotations, self.origins
        return T

    def to_pads(self, points: Array) -> Array:
        """Transform world point i into the frame of the patch of pad i, shape (pads, 3)."""
        return np.asarray(np.einsum("pji,pj->pi", self.rotations, points - self.origins))

    def faces(self, points: Array) -> list[Array]:
        """Return the part of pad i in its tangent plane nearest to world point i; world, shape (k, 3) each, m."""
        local = zip(self.pads, self.to_pads(points), self.rotations, self.origins, strict=True)
        return [contact_face(pad.patch, point) @ R.T + origin for pad, point, R, origin in local]

    def rubber(self, points: Array) -> list[Rubber]:
        """Return where the rubber of pad i touches what is tangent to it at world point i; world."""
        local = zip(self.pads, self.to_pads(points), strict=True)
        found = [rubber_at(pad.patch, point, pad.rubber_depth) for pad, point in local]
        poses = zip(found, self.rotations, self.origins, strict=True)
        # From the patch's frame into the world: the pose of the world in the patch's frame.
        return [rubber.moved(R.T, -R.T @ origin) for rubber, R, origin in poses]

    def tilts(self, points: Array, inward: Array, turn: float) -> tuple[Array, Array]:
        """Return the tilts of the pads about their two axes and about any, and their limits, rad, shape (pads, 3) each.

        With n the inward normal at world point i in the frame of pad i there, and a and b half its sides, rubber that
        yields by d allows atan(d / a) along x and atan(d / b) along y, of atan(|n_x| / n_z) and atan(|n_y| / n_z). The
        normal may be off by `turn`, rad. The angle of n with the pad's normal is at most `LARGEST_TILT`.
        """
        local = zip(self.pads, self.to_pads(points), self.rotations, inward, strict=True)
        normals = np.array([rubber_at(pad.patch, point, 0.0).rotation.T @ R.T @ n for pad, point, R, n in local])
        allowed = [np.arctan2(pad.rubber_depth, half_sides(pad.patch)) + turn for pad in self.pads]
        slopes = np.column_stack([np.abs(normals[:, :2]), np.linalg.norm(normals[:, :2], axis=1)])
        limits = np.column_stack([allowed, np.full(len(allowed), LARGEST_TILT)])
        return np.arctan2(slopes, normals[:, 2:]), limits

    def rims(self, points: Array) -> Array:
        """Return how far world point i is from the rim of pad i, along the pad, shape (pads,), m."""
        local = zip(self.pads, self.to_pads(points), strict=True)
        return np.array([rim_distance(pad.patch, point) for pad, point in local])

    def nearest(self, points: Array) -> tuple[Array, Array]:
        """Return the distance of point i to pad i, shape (pads,), m, and the pad's outward normal there, (pads, 3).

        Points and normals are in the world.
        """
        found = [nearest_on_patch(pad.patch, point) for pad, point in zip(self.pads, self.to_pads(points), strict=True)]
        distances, normals = zip(*found, strict=True)
        return np.array(distances), np.einsum("pij,pj->pi", self.rotations, np.array(normals))


def contact_figures(points: Array, inward: Array, pads: Pads, target: PlacedShape) -> list[Figure]:
    """Return the figures of the contact points.

    Args:
        points: contact points, world, shape (contacts, 3), m.
        inward: inward normals of the object there, world, shape (contacts, 3).
        pads: the pads, contact i on pad i.
        target: the object.
    """
    gaps, limits = np.abs([target.distance(point) for point in points]), target.limits
    off, normals = pads.nearest(points)
    return [
        _largest("contact gap", gaps, limits.gap, "m", pads.names),
        _largest("contact on pad", off, 1e-6, "m", pads.names),
        _tilt_in_cone(points, inward, pads, limits.turn) if limits.yields else _tilt(normals, inward, pads),
    ]


def _tilt(normals: Array, inward: Array, pads: Pads) -> Figure:
    # Exact for small and large angles alike, which arccos is not.
    tilts = 2 * np.arctan2(np.linalg.norm(normals - inward, axis=1), np.linalg.norm(normals + inward, axis=1))
    return _largest("pad tangency", tilts, 2e-3, "rad", pads.names)


def _tilt_in_cone(points: Array, inward: Array, pads: Pads, turn: float) -> Figure:
    """Return the tilt of the pad, about one of its axes or any, that is nearest to its limit."""
    tilts, limits = pads.tilts(points, inward, turn)
    pad, axis = np.unravel_index(int((tilts - limits).argmax()), tilts.shape)
    limit = float(limits[pad, axis])
    return Figure("pad tangency", float(tilts[pad, axis]), limit, "rad", "at most", pads.names[int(pad)])


def footprints(points: Array, normals: Array, pads: Pads, target: PlacedShape) -> list[Array]:
    """Return the footprint of each contact, world, shape (k, 3) each, m.

    Args:
        points: contact points, world, shape (contacts, 3), m.
        normals: of the contacts, world, shape (contacts, 3).
        pads: the pads, contact i on pad i.
        target: the object.
    """
    return [target.footprint(*given) for given in zip(pads.faces(points), points, normals, strict=True)]


def region_figure(points: Array, region: Region, pads: Pads, target: PlacedShape) -> Figure:
    """Return how deep the least deep contact point is in the region where contact may be, m."""
    found = depths(region, np.array([target.to_object(point) for point in points]))
    return _least("contact region", found.tolist(), -REGION_TOLERANCE - target.limits.region, pads.names)


def footprint_figure(
    areas: Sequence[Array], rubber: Sequence[Rubber], region: Region, pads: Pads, target: PlacedShape
) -> Figure:
    """Return how deep the least deep part of a footprint is in the region where contact may be, m.

    Args:
        areas: the footprints, world, shape (k, 3) each.
        rubber: of the contacts, world.
        region: in the object's frame.
        pads: contact i on pad i.
        target: the object.
    """
    depths = [target.region_depth(region, *given) for given in zip(areas, rubber, strict=True)]
    return _least("contact region", depths, -FOOTPRINT_TOLERANCE - target.limits.region, pads.names)


def rim_figures(points: Array, pads: Pads, target: PlacedShape, reserve: float) -> list[Figure]:
    """Return how far the contact points are from the rims of their pads and from the edges of the object's faces, m.

    Without the second if the object has no edges.

    Args:
        points: contact points, world, shape (contacts, 3), m.
        pads: contact i on pad i.
        target: the object.
        reserve: least distance that is wanted, m.
    """
    edges = [target.edge(point) for point in points]
    figures = [_least("pad rim", pads.rims(points).tolist(), reserve - RIM_TOLERANCE, pads.names)]
    if min(edges) < math.inf:
        figures.append(_least("surface edge", edges, reserve - EDGE_TOLERANCE, pads.names))
    return figures


def known_normals(inward: Array, points: Array, pads: Pads) -> Array:
    """Return inward normals, shape (contacts, 3); where the object has none, on its axis, that of the pad will do.

    Such a contact is refuted anyway.
    """
    known = np.isfinite(inward).all(axis=1, keepdims=True)
    return inward if known.all() else np.where(known, inward, pads.nearest(points)[1])


def _least(name: str, values: Sequence[float], limit: float, pads: tuple[str, ...]) -> Figure:
    worst = int(np.argmin(values))
    return Figure(name, float(values[worst]), limit, "m", "at least", pads[worst])


def _largest(name: str, values: Array, limit: float, unit: str, pads: tuple[str, ...]) -> Figure:
    worst = int(values.argmax())
    return Figure(name, float(values[worst]), limit, unit, "at most", pads[worst])
