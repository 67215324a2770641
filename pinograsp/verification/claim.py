"""A solver's claim, in terms that anyone can recompute: joint angles by name, contacts and forces."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import Array


@dataclass(frozen=True)
class Claim:
    """A grasp as claimed. Contact i belongs to pad i of the robot file."""

    joints: dict[str, float]
    """Angle (rad) or displacement (m) of every movable joint of the URDF, mimic joints included."""
    points: Array
    """Contact points in the world, m, shape (contacts, 3)."""
    forces: Array
    """Forces on the object in the world, N, shape (contacts, 3)."""
    spin_torques: Array
    """Torques on the object about the pads' outward normals, N m, shape (contacts,); 0 for hard fingers."""
