"""What a solver claims, in terms that anyone can recompute: joint angles by name, contacts and forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Claim:
    """A grasp as claimed. Contact i belongs to pad i of the robot file."""

    joints: dict[str, float]
    """Angle (rad) or displacement (m) of every movable joint of the URDF, mimic joints included."""
    points: NDArray[np.float64]
    """Contact points in the world, m, shape (contacts, 3)."""
    forces: NDArray[np.float64]
    """Forces on the object in the world, N, shape (contacts, 3)."""
    spin_torques: NDArray[np.float64]
    """Torques on the object about the pads' outward normals, N m, shape (contacts,); 0 for hard fingers."""
