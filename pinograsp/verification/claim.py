"""The claim of a solver in terms that anyone can recompute: joint angles by name, contacts and forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..arrays import Array
from ..frozen import Record


@dataclass(frozen=True, eq=False, repr=False)
class Claim(Record):
    """A grasp as claimed. Contact i belongs to pad i of the robot file."""

    joints: Mapping[str, float]
    """Angle (rad) or displacement (m) of every movable joint of the URDF, mimic joints included."""
    points: Array
    """Contact points in the world, m, shape (contacts, 3)."""
    forces: Array
    """Forces on the object in the world, N, shape (contacts, 3)."""
    spin_torques: Array
    """Torques on the object about its inward normals at the points, N m, shape (contacts,); 0 for hard fingers.

    Where pads are tangent these are the outward normals of the pads.
    """
