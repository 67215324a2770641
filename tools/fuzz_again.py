"""A saved input run again, and made smaller."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

from fuzz_judge import OUTCOMES, failure_of
from fuzz_kinds import KINDS
from fuzz_supervisor import supervised


def again(folder: Path, scratch: Path) -> str:
    """Return the name of what comes of the files of a saved input, in a child of limited time and memory."""

    def work(numbers: range, pipe: int) -> None:
        copied = Path(shutil.copytree(folder, scratch / "input", dirs_exist_ok=True))
        os.write(pipe, b"0 begun\n")
        outcome, details = failure_of(KINDS[folder.name.split("-")[0]], copied, True)
        said = details.splitlines()[-1:] if outcome not in OUTCOMES else []
        os.write(pipe, f"0 {' '.join([outcome, *said])}\n".encode())

    ((_, outcome),) = supervised(work, range(1), scratch / "log")
    shutil.rmtree(scratch / "input")
    return outcome


def minimised(folder: Path, file: Path) -> None:
    """Leave out lines of a file, or bytes, as long as the input fails in the same way."""
    with tempfile.TemporaryDirectory() as name:
        wanted = again(folder, Path(name))
        parts = file.read_bytes().splitlines(keepends=True)
        if len(parts) < 2:
            parts = [bytes([byte]) for byte in b"".join(parts)]
        size = len(parts) // 2
        while size:
            for begin in range(0, len(parts), size):
                fewer = [*parts[:begin], *parts[begin + size :]]
                file.write_bytes(b"".join(fewer))
                if again(folder, Path(name)) == wanted:
                    parts = fewer
                    break
            else:
                size //= 2
        file.write_bytes(b"".join(parts))
