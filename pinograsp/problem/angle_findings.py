"""Angles that are more than a turn: degrees that are given for radians."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from ..descriptions import RobotDescription, Scene
from ..descriptions.model import Frozen
from ..descriptions.pose import Pose

TURN = 2.0 * math.pi
ROUNDED = 0.01
"""What a whole turn may be rounded by, rad."""


def angle_findings(*files: Scene | RobotDescription) -> list[str]:
    """Return what is odd about the poses of scene and robot file, a sentence for each `rpy`."""
    return [
        f"{key}.rpy has an angle of {angle:g} rad, more than a turn: angles are in radians, "
        f"and {angle:g} degrees are {math.radians(angle):.4f}"
        for file in files
        for key, pose in _poses(file, "")
        if (angle := max(pose.rpy, key=abs)) and abs(angle) > TURN + ROUNDED
    ]


def _poses(part: object, key: str) -> Iterator[tuple[str, Pose]]:
    """Yield the poses within a part of a file, however deep, each with its key path."""
    if isinstance(part, Pose):
        yield key, part
    if isinstance(part, Frozen):
        part = part.fields()
    if isinstance(part, Mapping):
        for name, inner in part.items():
            yield from _poses(inner, f"{key}.{name}" if key else str(name))
    elif isinstance(part, tuple):
        for index, inner in enumerate(part):
            yield from _poses(inner, f"{key}[{index}]")
