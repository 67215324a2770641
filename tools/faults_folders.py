"""Folders that are read-only, full, missing, or a file."""

from __future__ import annotations

import contextlib
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from faults_machine import (
    LONG,
    NOBODY,
    PLAN,
    WrongError,
    require_clean,
)
from faults_outcomes import check_plan
from faults_series import Faults


def folders(faults: Faults) -> None:
    """Give commands a cache or an output folder that cannot be used."""
    kinds: dict[str, Callable[[Path], contextlib.AbstractContextManager[Path]]] = {
        "a file in the way": _file_in_the_way,
        "a file in place of it": _file_in_place,
    }
    if _may_mount(faults.fresh()):
        kinds |= {
            "read-only": lambda folder: _mounted(folder, "ro,size=1m"),
            "full at once": lambda folder: _mounted(folder, "size=4k"),
            "full after 1 MB": lambda folder: _mounted(folder, "size=1m"),
        }
    else:
        print("no tmpfs may be mounted: read-only and full folders are left out", file=sys.stderr)
    for kind, made in kinds.items():
        with faults.row(f"the cache folder is {kind}", "plan") as outcomes, faults.judged(outcomes, f"cache {kind}"):
            folder = faults.fresh()
            with made(folder) as cache:
                _plans_without(faults, folder, str(cache), {"PINOGRASP_CACHE": str(cache)})
                if cache.is_dir():
                    require_clean(cache)
            outcomes["planned, one warning"] += 1
        for name in ("plan", "build", "report"):
            words = faults.subjects[name].words
            with faults.row(f"the folder of the files is {kind}", name) as outcomes, faults.judged(outcomes, kind):
                folder = faults.started(name)
                with made(folder) as out:
                    build = (*words[:2], out / "rows.duckdb", *words[3:])
                    words = build if name == "build" else (*words, "--out", out)
                    done = faults.machine.run(folder, *words)
                    if done.code == 0 and kind == "full after 1 MB":
                        outcomes["there was room"] += 1
                        continue
                    last = done.require(2).errors.strip().splitlines()[-1]
                    if not (last.startswith("error: ") and str(out) in last):
                        raise WrongError(last)
                    if out.is_dir():
                        require_clean(out)
                outcomes["one line"] += 1
    homes: dict[str, tuple[str | None, dict[str, Any]]] = {
        "HOME is nothing": ("", {}),
        "HOME is no folder": ("/dev/null/nobody", {}),
    }
    if _nobody_runs_python():
        homes["HOME is not set, nor is the user known"] = (None, {"user": NOBODY})
    for said, (home, streams) in homes.items():
        with faults.row(said, "plan") as outcomes, faults.judged(outcomes, said):
            variables = {"PINOGRASP_CACHE": None, "XDG_CACHE_HOME": None, "HOME": home}
            where = faults.fresh()
            where.chmod(0o777)
            _plans_without(faults, where, "" if home == "" else "cache", variables, **streams)
            outcomes["planned"] += 1


def _plans_without(
    faults: Faults, folder: Path, named: str, environment: Mapping[str, str | None], **streams: Any
) -> None:
    done = faults.machine.run(folder, *PLAN, environment=environment, most=LONG, **streams).require(0)
    check_plan(folder, done, None, faults.subjects["plan"].whole)
    warned = [line for line in done.errors.splitlines() if "PINOGRASP_CACHE" in line]
    if named and (len(warned) != 1 or named not in warned[0]):
        raise WrongError(f"warnings: {warned}")


@contextlib.contextmanager
def _file_in_the_way(folder: Path) -> Iterator[Path]:
    (folder / "file").write_text("")
    yield folder / "file" / "folder"


@contextlib.contextmanager
def _file_in_place(folder: Path) -> Iterator[Path]:
    (folder / "file").write_text("")
    yield folder / "file"


@contextlib.contextmanager
def _mounted(folder: Path, options: str) -> Iterator[Path]:
    place = folder / "place"
    place.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", place], check=True)
    try:
        yield place
    finally:
        subprocess.run(["umount", place], check=True)


def _nobody_runs_python() -> bool:
    """Whether a command can be run as a user of whom the system knows nothing."""
    try:
        return subprocess.run([sys.executable, "-c", "import pinograsp"], user=NOBODY).returncode == 0
    except OSError as error:
        print(f"no unknown user may run Python: {error}", file=sys.stderr)
        return False


def _may_mount(folder: Path) -> bool:
    try:
        with _mounted(folder, "size=4k"):
            return True
    except (OSError, subprocess.CalledProcessError):
        return False
