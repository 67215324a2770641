"""Figures of the contact points: on the object, on the pads, pads tangent to the object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..descriptions.hand import PadDescription
from ..descriptions.regions import Region
from .certificate import Figure
from .kinematics import Poses
from .patches import nearest_on_patch
from .regions import depth
from .shapes import PENETRATION, PlacedShape

REGION_TOLERANCE = 1e-9
"""How far a contact may be outside its region, m."""


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

    def nearest(self, points: Array) -> tuple[Array, Array]:
        """Return the distance of point i to pad i, shape (pads,), m, and the pad's outward normal there, (pads, 3).

        Points and normals are in the world.
        """
        local = np.einsum("pji,pj->pi", self.rotations, points - self.origins)
        found = [nearest_on_patch(pad.patch, point) for pad, point in zip(self.pads, local, strict=True)]
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
    gaps = np.abs([target.distance(point) for point in points])
    off, normals = pads.nearest(points)
    # Exact for small and large angles alike, which arccos is not.
    tilts = 2 * np.arctan2(np.linalg.norm(normals - inward, axis=1), np.linalg.norm(normals + inward, axis=1))
    return [
        _largest("contact gap", gaps, PENETRATION, "m", pads.names),
        _largest("contact on pad", off, 1e-6, "m", pads.names),
        _largest("pad tangency", tilts, 2e-3, "rad", pads.names),
    ]


def region_figure(points: Array, region: Region, pads: Pads, target: PlacedShape) -> Figure:
    """Return how deep the least deep contact is in the region where contact may be, m."""
    depths = [depth(region, target.to_object(point)) for point in points]
    worst = int(np.argmin(depths))
    return Figure("contact region", depths[worst], -REGION_TOLERANCE, "m", "at least", pads.names[worst])


def _largest(name: str, values: Array, limit: float, unit: str, pads: tuple[str, ...]) -> Figure:
    worst = int(values.argmax())
    return Figure(name, float(values[worst]), limit, unit, "at most", pads[worst])
