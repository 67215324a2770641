"""Many plans at once on one cache."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import duckdb

from faults_machine import (
    LONG,
    PLAN,
    Done,
    WrongError,
    require_clean,
)
from faults_outcomes import check_plan
from faults_series import Faults


def shared(faults: Faults, plans: int = 8) -> None:
    """Begin plans at once on an empty cache, while somebody has its database open for writing."""
    with faults.row(f"{plans} plans at once, no cache", "plan") as outcomes:
        cache = faults.fresh()
        shutil.copytree(faults.machine.cache / "covers", cache / "covers")
        _at_once(faults, plans, cache, outcomes)
    with faults.row("its database is open for writing elsewhere", "plan") as outcomes:
        (file,) = cache.glob("*.duckdb")
        writer = "import duckdb, sys; c = duckdb.connect(sys.argv[1]); print(flush=True); sys.stdin.read()"
        with subprocess.Popen(
            [sys.executable, "-c", writer, file], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        ) as other:
            assert other.stdout is not None
            other.stdout.readline()
            _at_once(faults, 2, cache, outcomes)
            other.kill()
    with faults.row("opened for writing while it plans", "plan") as outcomes, faults.judged(outcomes, "a writer"):

        def write(process: subprocess.Popen[str]) -> None:
            while process.poll() is None:
                duckdb.connect(str(file)).close()
                time.sleep(0.05)

        done = faults.machine.run(faults.fresh(), *PLAN, at=write, environment={"PINOGRASP_CACHE": str(cache)})
        done.require(0)
        outcomes["neither waits"] += 1


def _at_once(faults: Faults, plans: int, cache: Path, outcomes: Counter[str]) -> None:
    def planned(folder: Path) -> Done:
        return faults.machine.run(folder, *PLAN, environment={"PINOGRASP_CACHE": str(cache)}, most=LONG)

    folders = [faults.fresh() for _ in range(plans)]
    with ThreadPoolExecutor(plans) as threads:
        for folder, done in zip(folders, threads.map(planned, folders), strict=True):
            with faults.judged(outcomes, "one of many"):
                check_plan(folder, done.require(0), None, faults.subjects["plan"].whole)
                outcomes["the same grasps"] += 1
    built = [json.dumps(str(file.name)) for file in cache.glob("*.duckdb")]
    with faults.judged(outcomes, "the cache"):
        require_clean(cache)
        if len(built) != 1 or list(cache.glob("*.unfinished")):
            raise WrongError(f"databases {built}")
