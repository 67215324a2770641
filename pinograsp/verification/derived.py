"""Numbers that a grasp reports besides its certificate, as they follow from the claim alone."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import Array


@dataclass(frozen=True)
class Derived:
    """Recomputed from a claim; contact i belongs to pad i."""

    normals: Array
    """Outward normals of the object at the contact points, world, shape (contacts, 3)."""
    synergies: Array
    """Synergies that come nearest to the joint angles, rad (m), shape (synergies,)."""
    T_world_wrist: Array
    """Pose of the wrist link, m, shape (4, 4)."""
    V: float
    """Cost of the contact forces (A7)."""
