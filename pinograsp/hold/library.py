"""Optional libraries, imported when they are needed: MuJoCo, and Pillow for films."""

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


def pillow() -> Any:
    """Return the modules Image and ImageDraw of Pillow.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        from PIL import Image, ImageDraw
    except ImportError:
        raise MissingExtraError("a film", "Pillow", "hold") from None
    return Image, ImageDraw
