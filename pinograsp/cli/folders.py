"""The folder that a command writes into."""

from __future__ import annotations

from pathlib import Path

from ..errors import InputError


def make_folder(folder: Path) -> None:
    """Make the folder of `--out`.

    Raises:
        InputError: it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(f"no such folder can be made: {reason}", file=folder, key="--out") from None
