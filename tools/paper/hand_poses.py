"""Poses of a two-pad hand around an object: opposite points on a grid of the surface, angles about the line."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pinograsp.descriptions.shapes import Cylinder, Shape, Sphere
from pinograsp.problem import TaskModel
from pinograsp.verification.regions import depth

ANGLES = 24
"""Angles about the line through two points."""
TURN = math.radians(2.0)
"""Step of directions on the surface."""
FARTHEST = 30
"""Most steps of a direction away from that of the desired points."""
SPHERE_TURN = math.radians(10.0)
"""Step of directions on a sphere, which has two of them."""
HEIGHT = 0.002
"""Step of heights on a cylinder, m."""
MOST = 1500
"""Pairs of points that are kept, those nearest to the desired points."""


@dataclass(frozen=True)
class Line:
    """Two opposite points of the surface, in the order of the desired points that they stand for."""

    points: np.ndarray
    """World, m, shape (2, 3)."""
    phi_mm2: float


def lines(model: TaskModel) -> list[Line]:
    """Return pairs of opposite points where contact may be, by rising distance from the desired points."""
    shape = model.scene.objects[model.task.object].shape
    region = model.task.contact_region
    T = model.T_world_object
    found = []
    for pair in _pairs(shape, np.array(model.task.desired_contacts)):
        if region is not None and min(depth(region, point) for point in pair) < -1e-9:
            continue
        points = pair @ T[:3, :3].T + T[:3, 3]
        found.append(Line(points, 1e6 * float(((points - model.desired_points) ** 2).sum())))
    return sorted(found, key=lambda line: line.phi_mm2)[:MOST]


def _pairs(shape: Shape, desired: np.ndarray) -> Iterator[np.ndarray]:
    """Yield pairs of opposite points in the object's frame, m, shape (2, 3)."""
    along = (desired[0] - desired[1]) / np.linalg.norm(desired[0] - desired[1])
    match shape:
        case Sphere():
            first, second = perpendicular(along)
            for tilt in np.arange(0.0, FARTHEST * TURN, SPHERE_TURN):
                for roll in np.arange(0.0, 2.0 * math.pi, SPHERE_TURN) if tilt else (0.0,):
                    aside = math.cos(roll) * first + math.sin(roll) * second
                    n = math.cos(tilt) * along + math.sin(tilt) * aside
                    yield shape.radius * np.array([n, -n])
        case Cylinder():
            middle = math.atan2(along[1], along[0])
            steps = math.floor(0.5 * shape.height / HEIGHT)
            for turn in TURN * np.arange(-FARTHEST, FARTHEST + 1):
                n = np.array([math.cos(middle + turn), math.sin(middle + turn), 0.0])
                for height in HEIGHT * np.arange(-steps, steps + 1):
                    up = np.array([0.0, 0.0, height])
                    yield np.array([up + shape.radius * n, up - shape.radius * n])
        case _:
            raise NotImplementedError(f"no grid of opposite points for {type(shape).__name__}")


def hand_frame(points: np.ndarray, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Return rotation (3, 3) and origin (3,) of a hand in the world.

    Its origin is in the middle between two points (2, 3), x points from the first to the second, z is the approach.
    """
    jaw = (points[1] - points[0]) / np.linalg.norm(points[1] - points[0])
    first, second = perpendicular(jaw)
    approach = math.cos(angle) * first + math.sin(angle) * second
    return np.column_stack([jaw, np.cross(approach, jaw), approach]), points.mean(axis=0)


def perpendicular(n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors that are perpendicular to a unit vector and to each other."""
    first = np.cross(n, np.eye(3)[int(np.abs(n).argmin())])
    first /= np.linalg.norm(first)
    return first, np.cross(n, first)
