"""Parts of the enclosure that the wrist reaches, and from which directions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Integers
from ..errors import InputError, positive_number, require_kind
from ..frozen import Record
from .store import Database, identity_of

SECTORS = 24
"""Approach directions are told apart by largest component with sign (6) and the signs of the two others (4)."""
MOST = 100_000_000
"""Voxels that are counted at most."""


@dataclass(frozen=True, eq=False, repr=False)
class Coverage(Record):
    """Counts per voxel of the enclosure."""

    origin: Array
    """Corner of the first voxel, m, world, shape (3,)."""
    voxel: float
    """Edge of a voxel, m."""
    counts: Integers
    """Configurations whose wrist is in the voxel, shape (nx, ny, nz)."""
    directions: Integers
    """How many of the `SECTORS` approach directions are among them, shape (nx, ny, nz)."""

    @classmethod
    def of(cls, database: Database, voxel: float = 0.05) -> Coverage:
        """Count the configurations of a database by voxel and approach direction.

        Args:
            database: an open database.
            voxel: edge of a voxel, m.

        Raises:
            InputError: the edge is not positive or too small, or the database is none.
        """
        require_kind("database", database, Database, remedy="Open it with `Database.open`")
        voxel = positive_number("voxel", voxel)
        walls = identity_of(database).enclosure["walls"]
        origin, end = np.array(walls["min"]), np.array(walls["max"])
        edges = np.ceil((end - origin) / voxel - 1e-9)
        if np.log10(edges).sum() > np.log10(MOST):
            raise InputError(f"is too small: the enclosure would have more than {MOST:,} voxels", key="voxel")
        shape = edges.astype(int)
        places = ", ".join(
            f"least(greatest(floor(({name} - {low}) / {voxel}), 0), {most - 1})::INTEGER AS v{name}"
            for name, low, most in zip("xyz", origin.tolist(), shape.tolist(), strict=True)
        )
        rows = database.select_columns(
            f"SELECT vx, vy, vz, count(*) AS total, count(DISTINCT sector) AS sectors "
            f"FROM (SELECT {places}, {_SECTOR} AS sector FROM configurations) GROUP BY vx, vy, vz"
        )
        index = (rows["vx"], rows["vy"], rows["vz"])
        counts, directions = np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=np.int64)
        counts[index], directions[index] = rows["total"], rows["sectors"]
        return cls(origin, voxel, counts, directions)

    @property
    def rows(self) -> int:
        """Number of configurations."""
        return int(self.counts.sum())

    @property
    def voxels(self) -> int:
        """Number of voxels."""
        return self.counts.size

    @property
    def mean_directions(self) -> float:
        """Mean number, no unit, of the approach directions of reached voxels; 0 if there is none."""
        often = self.directions[self.counts > 0]
        return float(often.mean()) if often.size else 0.0

    @property
    def reached(self) -> float:
        """Share of the voxels that the wrist reaches."""
        return float((self.counts > 0).mean())


_SECTOR = (
    "CASE greatest(abs(ax), abs(ay), abs(az)) "
    "WHEN abs(ax) THEN (ax > 0)::INTEGER * 4 + (ay > 0)::INTEGER * 2 + (az > 0)::INTEGER "
    "WHEN abs(ay) THEN 8 + (ay > 0)::INTEGER * 4 + (ax > 0)::INTEGER * 2 + (az > 0)::INTEGER "
    "ELSE 16 + (az > 0)::INTEGER * 4 + (ax > 0)::INTEGER * 2 + (ay > 0)::INTEGER END"
)
