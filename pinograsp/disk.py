"""Files: written whole or not at all, told apart by their content, and the folder for what can be computed again."""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path

from .errors import InputError


def cache_folder() -> Path:
    """Return the cache folder: PINOGRASP_CACHE, or pinograsp below XDG_CACHE_HOME or ~/.cache.

    Raises:
        InputError: none of them is known: the user has no home folder.
    """
    if own := os.environ.get("PINOGRASP_CACHE"):
        return Path(own)
    if base := os.environ.get("XDG_CACHE_HOME"):
        return Path(base) / "pinograsp"
    try:
        return Path.home() / ".cache" / "pinograsp"
    except RuntimeError:
        problem, remedy = "there is no home folder for the cache", "Set PINOGRASP_CACHE to a folder that can be written"
        raise InputError(problem, remedy=remedy) from None


def write_whole(file: Path, content: str | bytes) -> None:
    """Write a file, text as UTF-8, so that a reader finds the old one or the whole new one; its folder is made.

    Raises:
        InputError: the file cannot be written.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{file.name}.", dir=file.parent) as folder:
            unfinished = Path(folder) / file.name
            unfinished.write_bytes(data)
            unfinished.replace(file)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(f"cannot be written: {reason}", file=file, remedy="Check the folder") from None


def digest(content: bytes) -> str:
    """Return the SHA-256 of some bytes, in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def digest_of(file: Path) -> str:
    """Return the SHA-256 of a file's content, in hexadecimal."""
    return digest(file.read_bytes())
