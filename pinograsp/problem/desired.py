"""Where contacts are wanted: the desired contacts of a task, or what is proposed to one start."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import Array


class DesiredPoints(NamedTuple):
    """Points of the object's surface, one for each pad."""

    points: Array
    """World, m, shape (n, 3)."""
    normals: Array
    """Outward normals of the surface there that pads are to look at; zero where any will do, shape (n, 3).

    Of the desired contacts of a task those on flat faces and uneven surfaces have one, of points that are proposed all.
    """


class Hold(NamedTuple):
    """A hand that holds a pair of points of an object, with nothing but hand and object in the way."""

    T_wrist: Array
    """Pose of the wrist, object's frame, or the world's for a start, m, shape (4, 4)."""
    synergies: Array
    """Posture of the hand, rad (m), shape (s,)."""
    parameters: Array
    """Contact parameters on the pads, shape (v - l - s,)."""
    assignment: tuple[int, ...]
    """Point that each pad touches."""
    axis: Array
    """About which the hand may turn, in the frame of the wrist's pose: a point, m, and the direction, shape (2, 3)."""
    turns: Array
    """By so much it may, each time a little less or more, rad, shape (k,)."""


class Proposal(NamedTuple):
    """What is proposed to a start: a pair of points, and hands that hold it."""

    desired: DesiredPoints
    holds: tuple[Hold, ...] = ()
    """World; none if the pair was not tried, or no hand came to hold it."""
