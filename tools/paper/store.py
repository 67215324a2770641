"""Results in a folder: what was computed once is loaded again if what it depends on is the same.

Every file says what it was computed from (`key`: digests of the robot's and the scene's files, task, options, number of
starts, seed) and by what (`made`: version and commit of pinograsp, machine). A file whose key differs is computed
again; one that another commit made is not, but the page says which commit that was.
"""

from __future__ import annotations

import dataclasses
import json
import os
import platform
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pinograsp
from pinograsp.descriptions import Scene
from pinograsp.disk import write_whole
from pinograsp.results.provenance import provenance

Key = dict[str, Any]


def key_of(robot: pinograsp.Robot, scene: Scene, task: str, **more: object) -> Key:
    """Return what a computation with a robot at a task depends on, as JSON gives it back (infinities as text)."""
    digests = provenance(robot.description, scene, robot.files)["sha256"]
    weight = scene.task(task).force_weight
    text = json.dumps({"sha256": digests, "task": task, "force_weight": weight, **more})
    key: Key = json.loads(text, parse_constant=str)
    return key


def made() -> dict[str, Any]:
    """Return what computes here: version and commit of pinograsp, machine."""
    return {
        "pinograsp": pinograsp.__version__,
        "commit": _commit(),
        "cores": os.cpu_count(),
        "processor": _processor(),
        "python": platform.python_version(),
    }


class Store:
    """A folder of results; with `fresh` nothing that an earlier run left there is loaded."""

    def __init__(self, folder: Path, *, fresh: bool = False) -> None:
        self._folder = folder
        self._fresh = fresh
        self._made = made()
        self.used: dict[str, dict[str, Any]] = {}
        """By name of every result that was asked for: what made it."""

    def result(self, name: str, key: Key, compute: Callable[[], pinograsp.Result]) -> pinograsp.Result:
        """Return a plan's result, loaded or computed; the file is one that `pinograsp.read_json` reads.

        Raises:
            KeyboardInterrupt: the plan was interrupted; it is not kept.
        """
        file = self._file(name)
        if file.exists() and not self._fresh:
            result = pinograsp.read_json(file)
            origin = result.provenance.get("reproduction", {})
            if origin.get("key") == key:
                self.used[name] = origin["made"]
                return result
        result = compute()
        if result.interrupted:
            raise KeyboardInterrupt
        origin = {"key": key, "made": self._made}
        result = dataclasses.replace(result, provenance={**result.provenance, "reproduction": origin})
        pinograsp.write_json(result, file)
        self.used[name] = self._made
        return result

    def data(self, name: str, key: Key, compute: Callable[[], Any]) -> Any:
        """Return JSON data, loaded or computed."""
        file = self._file(name)
        if file.exists() and not self._fresh:
            content = json.loads(file.read_text(encoding="utf-8"))
            if content["key"] == key:
                self.used[name] = content["made"]
                return content["data"]
        data = compute()
        write_whole(file, json.dumps({"key": key, "made": self._made, "data": data}) + "\n")
        self.used[name] = self._made
        return data

    def _file(self, name: str) -> Path:
        return self._folder / f"{name}.json"


class Lines:
    """Prints how far a piece of work is: at most a line every ten seconds, and the end of each stage."""

    def __init__(self) -> None:
        self._printed = time.monotonic()

    def __call__(self, progress: pinograsp.Progress) -> None:
        """Say how far it is."""
        if progress.done != progress.total and time.monotonic() - self._printed < 10.0:
            return
        self._printed = time.monotonic()
        print(f"  {progress}", flush=True)


def _commit() -> str:
    """Return the commit of the pinograsp that runs, `-dirty` if it was changed since; unknown outside a clone."""
    command = ["git", "-C", str(Path(pinograsp.__file__).parent), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def _processor() -> str:
    """Return the processor's name; /proc knows it where the platform module does not."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
