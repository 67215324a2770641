"""What stands in the room: shapes at poses, and those of them that are to be grasped."""

from __future__ import annotations

from .model import Frozen
from .pose import Pose
from .shapes import Shape
from .values import OptionalVector3, Positive, as_default


class Body(Frozen):
    """A shape at a pose: an obstacle or an object."""

    shape: Shape
    """In its own frame, m."""
    pose: Pose = Pose()
    """Of the shape's frame in the world, m and rad."""


class Object(Body):
    """Something to grasp; in the tasks of other objects it is an obstacle."""

    center_of_mass: OptionalVector3 = as_default(None)
    """In the object's frame, m; by default that of its shape, filled evenly."""
    mass: Positive | None = None
    """kg; by default what a task's external force weighs in the gravity of the scene."""
