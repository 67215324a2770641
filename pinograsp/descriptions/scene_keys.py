"""Errors about keys of a scene, told with the file that the scene is from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from ..errors import InputError
from .scene import Scene

SAID = ("enclosure", "mounting", "gravity", "obstacles", "objects", "tasks")
"""Keys of a scene that errors are about."""


@contextmanager
def scene_keys(scene: Scene, file: Path | None) -> Iterator[None]:
    """Have errors about keys of a scene name its file: a scene that was changed since no longer knows it.

    Args:
        scene: with what the file has, changed or not.
        file: that it is from; None: it was made in Python, and errors stay as they are.

    Raises:
        InputError: what was raised in the block.
    """
    try:
        yield
    except InputError as error:
        if file is None or error.file is not None or not _has(scene, error.key or ""):
            raise
        raise type(error)(error.problem, file=file, key=error.key, remedy=error.remedy) from None


def _has(scene: Scene, key: str) -> bool:
    """Return whether a key, such as `objects.can.pose`, is one of a scene."""
    table, _, rest = key.partition(".")
    if table not in SAID:
        return False
    parts = getattr(scene, table)
    return not (rest and isinstance(parts, Mapping)) or any(f"{rest}.".startswith(f"{name}.") for name in parts)
