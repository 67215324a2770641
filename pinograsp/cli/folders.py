"""The folder that a command writes into."""

from __future__ import annotations

from pathlib import Path

from ..disk import reason_of
from ..errors import FileError


def make_folder(folder: Path) -> None:
    """Make the folder of `--out`.

    Raises:
        FileError: it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"no such folder can be made: {reason_of(error)}", file=folder, key="--out") from None
