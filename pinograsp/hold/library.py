"""MuJoCo, imported when it is needed."""

from __future__ import annotations

from typing import Any

from ..errors import MissingExtraError


def mujoco() -> Any:
    """Return the module mujoco.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        import mujoco as library
    except ImportError:
        raise MissingExtraError("the hold test", "MuJoCo", "hold") from None
    return library
