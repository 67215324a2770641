"""Poses: position and roll, pitch, yaw."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from ..arrays import Array, Rows, real_array
from ..errors import InputError
from ..frozen import frozen
from .model import Frozen
from .values import Vector3, as_default

ZERO = (0.0, 0.0, 0.0)


class Pose(Frozen):
    """A frame in another one: position (m) and roll, pitch, yaw (rad) about the fixed axes x, y, z, as in URDF."""

    position: Vector3 = as_default(ZERO)
    """Origin of the frame, m."""
    rpy: Vector3 = as_default(ZERO)
    """Roll, pitch and yaw: turns about the fixed x, then y, then z, rad."""

    @classmethod
    def of(cls, T: Rows) -> Pose:
        """Return the pose of a homogeneous transform, shape (4, 4).

        Raises:
            InputError: it is none.
        """
        matrix = real_array("pose", T, 4, 4)
        R = matrix[:3, :3]
        rigid = np.allclose(R.T @ R, np.eye(3), atol=1e-6) and np.linalg.det(R) > 0.0
        if not (rigid and np.allclose(matrix[3], [0.0, 0.0, 0.0, 1.0])):
            raise InputError("is no homogeneous transform: a rotation and a translation are wanted", key="pose")
        across = math.hypot(R[0, 0], R[1, 0])
        pitch = math.atan2(-R[2, 0], across)
        if across > 1e-9:
            roll, yaw = math.atan2(R[2, 1], R[2, 2]), math.atan2(R[1, 0], R[0, 0])
        else:
            roll, yaw = 0.0, math.atan2(-R[0, 1], R[1, 1])
        x, y, z = matrix[:3, 3].tolist()
        return cls(position=(x, y, z), rpy=(roll, pitch, yaw))

    @cached_property
    def matrix(self) -> Array:
        """Homogeneous transform of the frame in the other one, m, shape (4, 4); read-only."""
        (cr, cp, cy), (sr, sp, sy) = (
            [math.cos(a) for a in self.rpy],
            [math.sin(a) for a in self.rpy],
        )
        T = np.eye(4)
        T[:3, :3] = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
        T[:3, 3] = self.position
        return np.asarray(frozen(T))
