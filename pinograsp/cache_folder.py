"""The folder for what can be computed again: start databases, convex covers of meshes."""

from __future__ import annotations

import os
from pathlib import Path


def cache_folder() -> Path:
    """Return the cache folder: PINOGRASP_CACHE, or pinograsp below XDG_CACHE_HOME or ~/.cache."""
    if own := os.environ.get("PINOGRASP_CACHE"):
        return Path(own)
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "pinograsp"
