"""MuJoCo, imported when it is needed."""

from __future__ import annotations

from typing import Any

from ..errors import InputError


def mujoco() -> Any:
    """Return the module mujoco.

    Raises:
        InputError: it is not installed.
    """
    try:
        import mujoco as library
    except ImportError:
        raise InputError("the hold test needs MuJoCo", remedy="Run pip install 'pinograsp[hold]'") from None
    return library
