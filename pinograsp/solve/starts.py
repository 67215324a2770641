"""Starts from the database: wrist in a bounded region around the object (section 3.5, Algorithm 1)."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..database import Database, spread_selection
from ..models import preshape
from ..problem import TaskModel


def starts_near(database: Database, model: TaskModel, count: int, seed: int) -> Array:
    """Return up to `count` postures (q_a, sigma), shape (found, l + s), spread over the task's region.

    The hand is open as wide as the desired points are apart. As in the paper the object itself does not count as an
    obstacle: starts belong to robot and enclosure.
    """
    found = spread_selection(database, model.load.center_of_mass, model.task.start_radius, count, seed=seed)
    synergies = preshape(model.robot, model.desired_points)
    return np.column_stack([found.q, np.tile(synergies, (len(found), 1))])
