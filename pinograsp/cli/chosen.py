"""The grasp of a result's file that a command is about."""

from __future__ import annotations

from pathlib import Path

from ..errors import InputError
from ..results import Grasp, Result


def chosen_grasp(result: Result, number: int, file: Path) -> Grasp:
    """Return a grasp by its number in the file, from 1.

    Raises:
        InputError: there is none of this number.
    """
    count = len(result.grasps)
    if not 1 <= number <= count:
        there = f"there are {count}, numbered from 1" if count else "there is none"
        raise InputError(f"no grasp {number}: {there}", file=file, key="--grasp")
    return result.grasps[number - 1]
