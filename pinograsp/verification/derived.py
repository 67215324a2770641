"""Numbers that a grasp reports besides its certificate, as they follow from the claim alone."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import Array
from ..frozen import Record


@dataclass(frozen=True, eq=False, repr=False)
class Derived(Record):
    """Recomputed from a claim; contact i belongs to pad i."""

    normals: Array
    """Outward normals (unit vectors) of the object at the contact points, world, shape (contacts, 3)."""
    synergies: Array
    """Synergies that come nearest to the joint angles, rad (m), shape (synergies,)."""
    T_world_wrist: Array
    """Pose of the wrist link, m, shape (4, 4)."""
    T_world_pads: Array
    """Poses of the pads' patch frames, m, shape (contacts, 4, 4)."""
    joint_order: tuple[str, ...]
    """Names of the movable joints in the order in which the URDFs have them."""
    V: float
    """Cost of the contact forces (A7), no unit."""
