"""Whether an input failed: what reading it raises, how a command ends, and what is written outside of a folder."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import traceback
from pathlib import Path
from typing import Any

from fuzz_kind import Kind
from pinograsp import PinograspError, cli

OUTCOMES = ("used", "refused")
_WRITES = {"open", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.symlink", "os.link", "os.truncate"}
_TO_WRITE = os.O_WRONLY | os.O_RDWR | os.O_CREAT
outside: list[str] = []
"""What was written outside of the folder since the input began."""


def failure_of(kind: Kind, folder: Path, command: bool) -> tuple[str, str]:
    """Return what comes of an input, `used`, `refused` or the name of a failure, and its details."""
    outside.clear()
    try:
        kind.use(folder)
        outcome = "used"
    except PinograspError as error:
        outcome = "refused"
        if "\n" in str(error):
            return "error of several lines", str(error)
    except MemoryError:
        return "memory", traceback.format_exc()
    except Exception as error:
        return type(error).__name__, traceback.format_exc()
    if command and kind.command is not None:
        code, errors = commanded(kind.command(folder))
        lines = [line for line in errors.splitlines() if line.startswith("error: ")]
        if code not in {0, 1, 2} or len(lines) > 1 or "Traceback" in errors:
            return "command", f"exit code {code}\n{errors}"
    if outside:
        return "file outside", "\n".join(outside)
    return outcome, ""


def commanded(arguments: list[str]) -> tuple[int, str]:
    """Return exit code and standard error of a command in this process."""
    output, errors = io.StringIO(), io.StringIO()
    given, sys.argv = sys.argv, ["pinograsp", *arguments]
    try:
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            cli.main()
        return 0, errors.getvalue()
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else int(ended.code is not None), errors.getvalue()
    except Exception:
        return -1, traceback.format_exc()
    finally:
        sys.argv = given


def watch(home: Path) -> None:
    """Notice whatever Python writes outside of a folder, from now on."""

    def look(event: str, arguments: tuple[Any, ...]) -> None:
        if event not in _WRITES or not arguments or not isinstance(arguments[0], str | bytes | os.PathLike):
            return
        if event == "open" and not (isinstance(arguments[2], int) and arguments[2] & _TO_WRITE):
            return
        path = os.path.realpath(os.fsdecode(arguments[0]))
        if "__pycache__" in path:  # what Numba and Python keep
            return
        if not path.startswith((f"{home}/", "/dev/", "/proc/")) and path != str(home):
            outside.append(f"{event} {path}")

    sys.addaudithook(look)
