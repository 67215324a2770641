"""Arrays that are kept in the user's cache folder, so that they are made once on a machine."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from .cache_folder import cache_folders, in_cache
from .disk import make_way, write_whole
from .errors import UnwritableError
from .seal import sealed, unsealed

Value = TypeVar("Value")


def kept(
    folder: str,
    name: str,
    make: Callable[[], Value],
    arrays_of: Callable[[Value], dict[str, Any]],
    value_of: Callable[[Mapping[str, Any]], Value],
) -> Value:
    """Return a value from its file in the cache folder, or make it and keep it there.

    A damaged file is made again, and a folder that cannot be written costs time only, and a warning.

    Args:
        folder: of the file within the cache folder.
        name: of the file without its suffix: whatever decides the value decides it.
        make: makes the value.
        arrays_of: what is written of it, by name.
        value_of: the value of what was read.
    """
    for place in cache_folders():
        with contextlib.suppress(OSError):
            content = unsealed((place / folder / f"{name}.npz").read_bytes())
            if content is not None:  # NumPy notices damage only here and there
                with np.load(io.BytesIO(content)) as data:
                    return value_of(data)
    made, stream = make(), io.BytesIO()
    np.savez(stream, **arrays_of(made))
    content = sealed(stream.getvalue())

    def write(place: Path) -> None:
        file = place / folder / f"{name}.npz"
        make_way(file)
        write_whole(file, content)

    with contextlib.suppress(UnwritableError):  # of a temporary folder, too
        in_cache(write)
    return made
