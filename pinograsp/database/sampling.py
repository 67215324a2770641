"""One batch of random configurations, tested.

Batch b of seed s draws from its own random generator, so that its rows do not depend on who computes it or when.
Angles are rounded to the stored precision before they are tested: what is stored is what was tested.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Indices
from ..collision.batch_clearance import BatchClearance
from ..collision.scene_world import enclosure_world
from ..descriptions import Scene
from ..descriptions.task import Margins
from ..kinematics.hand_posture import hand_opening
from ..kinematics.robot import Robot
from .spread import Spread

DRAWS = 65_536
"""Samples in a batch."""
_BLOCK = 16_384
_PILOT = 1_000_000
"""Batches from this number on only estimate the density of wrist positions."""
_PILOT_BATCHES = 2
_VOXEL = 0.05
_CURVE_BITS = 10


@dataclass(frozen=True)
class Batch:
    """The accepted samples of a batch, as columns of the table."""

    number: int
    columns: dict[str, NDArray[Any]]

    @property
    def accepted(self) -> int:
        """Number of rows."""
        return len(self.columns["sample"])


class BatchSampler:
    """Draws batches for a robot in an enclosure."""

    def __init__(self, robot: Robot, scene: Scene, margins: Margins, seed: int, spread: Spread) -> None:
        mounted = robot.mounted(scene.mounting.matrix)
        self._clearance = BatchClearance(mounted, enclosure_world(mounted, scene, margins), hand_opening(mounted))
        self._low, self._high = _range(mounted)
        self._origin = np.array(scene.enclosure.min)
        self._size = np.array(scene.enclosure.max) - self._origin
        self._seed = seed
        self._keep: Array | None = None
        if spread == "wrist":
            self._keep = self._estimate_density()

    def __call__(self, number: int) -> Batch:
        """Draw and test one batch."""
        rng = np.random.default_rng([self._seed, number])
        parts = [self._block(rng, start) for start in range(0, DRAWS, _BLOCK)]
        columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        columns["sample"] = columns["sample"] + number * DRAWS
        return Batch(number, columns)

    def _block(self, rng: np.random.Generator, first: int) -> dict[str, NDArray[Any]]:
        uniform = rng.random((_BLOCK, len(self._low)))
        chance = rng.random(_BLOCK)
        q = (self._low + uniform * (self._high - self._low)).astype(np.float32)
        kept, clearance, frames = self._clearance.measure(q.astype(float))
        positions, approaches = self._clearance.kinematics.wrist(frames)
        if self._keep is not None:
            even = chance[kept] < self._keep[tuple(self._voxels(positions).T)]
            kept, clearance = kept[even], clearance[even]
            positions, approaches = positions[even], approaches[even]
        columns = {f"q{i}": q[kept, i - 1] for i in range(1, q.shape[1] + 1)}
        columns |= {name: positions[:, i].astype(np.float32) for i, name in enumerate(("x", "y", "z"))}
        columns |= {name: approaches[:, i].astype(np.float32) for i, name in enumerate(("ax", "ay", "az"))}
        columns["clearance"] = clearance.astype(np.float32)
        columns["cell"] = self._morton(positions)
        columns["sample"] = kept + first
        return columns

    def _morton(self, positions: Array) -> NDArray[np.uint32]:
        """Return the position on a Z-order curve through the enclosure: the bits of x, y, z in turn."""
        scaled = np.clip((positions - self._origin) / self._size, 0.0, 1.0 - 1e-9)
        steps = (scaled * (1 << _CURVE_BITS)).astype(np.uint32)
        cells = np.zeros(len(positions), dtype=np.uint32)
        for bit in range(_CURVE_BITS):
            for axis in range(3):
                cells |= ((steps[:, axis] >> bit) & 1) << (3 * bit + axis)
        return cells

    def _voxels(self, positions: Array) -> Indices:
        shape = np.ceil(self._size / _VOXEL).astype(int)
        return np.asarray(np.clip(((positions - self._origin) / _VOXEL).astype(int), 0, shape - 1))

    def _estimate_density(self) -> Array:
        """Return the share of samples to keep in every voxel so that wrist positions are even where they can be."""
        counts = np.zeros(np.ceil(self._size / _VOXEL).astype(int))
        for number in range(_PILOT_BATCHES):
            columns = self(_PILOT + number).columns
            voxels = self._voxels(np.column_stack([columns[name] for name in ("x", "y", "z")]))
            np.add.at(counts, tuple(voxels.T), 1.0)
        wanted = np.quantile(counts[counts > 0], 0.25)
        return np.asarray(np.minimum(1.0, wanted / np.maximum(counts, 1.0)))


def _range(robot: Robot) -> tuple[Array, Array]:
    """Return the limits of the arm joints; of a continuous joint, one turn."""
    low, high = robot.lower[: robot.arm_size].copy(), robot.upper[: robot.arm_size].copy()
    for i, name in enumerate(robot.description.arm.joints):
        if robot.urdf.movable[name] == "continuous":
            low[i], high[i] = max(low[i], -math.pi), min(high[i], math.pi)
    return low, high
