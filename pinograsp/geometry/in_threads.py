"""Compiled functions of many points that use all cores."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from ..arrays import Array, Indices
from ..threads import on_all_cores

AT_ONCE = 4096
"""Points that a thread takes at a time, for any number of threads: what is found for a point may depend on that before
it, in its last digit."""


def in_threads(function: Callable[..., None], tree: Any, points: Array, *found: Array | Indices) -> None:
    """Have a function write what it finds for points, in threads as `on_all_cores` has them.

    Args:
        function: of the tree, of some points, and of the same rows of what is written; `compiled_for_threads`.
        tree: given to each call.
        points: shape (n, 3).
        found: written by row, shape (n, ...).
    """
    rows = [slice(start, start + AT_ONCE) for start in range(0, len(points), AT_ONCE)]
    on_all_cores([partial(function, tree, points[some], *(part[some] for part in found)) for some in rows])
