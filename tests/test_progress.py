"""What is said of work that takes long, to who asked for nothing."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path
from typing import Any

import pytest
from conftest import SceneFactory

import pinograsp
from pinograsp import Robot
from pinograsp.database import cache as cache_module
from pinograsp.progress import OnceTold, Progress

BUILT = (
    "pinograsp: a start database for this robot, room and margins is built, once on this machine; "
    "progress=print says how far it is\n"
)
MADE = (
    "pinograsp: convex pieces of the robot's meshes are made, once on this machine; progress=print says how far it is\n"
)


def test_what_is_made_once_is_said_once_if_it_takes_long(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    told = OnceTold()
    said = []
    for seconds, progress in (
        (0.0, Progress("compiling", 0)),
        (1.9, Progress("compiling", 7)),
        (2.0, Progress("convex pieces", 0, 17)),
        (3.9, Progress("convex pieces", 1, 17)),
        (4.0, Progress("convex pieces", 2, 17)),
        (9.0, Progress("convex pieces", 3, 17)),
        (9.1, Progress("start database", 0, 100_000)),
        (30.0, Progress("start database", 9000, 100_000)),
        (31.0, Progress("starts", 1, 1304)),
        (99.0, Progress("starts", 1304, 1304)),
    ):
        now[0] = 100.0 + seconds
        told(progress)
        said.append(capsys.readouterr().err)
    assert said == ["", "", "", "", MADE, "", BUILT, "", "", ""]


@pytest.mark.parametrize("number", [errno.EPIPE, errno.ENOSPC])
def test_a_line_that_cannot_be_written_ends_nothing(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(sys.stderr, "write", fail)
    OnceTold()(Progress("start database", 0))
    monkeypatch.setattr(sys, "stderr", None)
    OnceTold()(Progress("start database", 0))


@pytest.mark.parametrize("asked", [True, False])
def test_a_plan_says_that_it_builds_a_database(
    asked: bool,
    toy: Robot,
    make_toy_scene: SceneFactory,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Unless progress is asked for; the second plan finds it."""
    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path))
    monkeypatch.setattr(cache_module, "SIZE", 20)
    seen: list[Progress] = []
    options: dict[str, Any] = {"progress": seen.append} if asked else {}
    for line in ("" if asked else BUILT, ""):
        with pinograsp.Planner(toy, make_toy_scene(), workers=1, **options) as planner:
            planner.first("ball", most=1)
        assert [each for each in capsys.readouterr().err.splitlines(keepends=True) if "database" in each] == [line][
            : bool(line)
        ]
    stages = [progress for progress in seen if progress.stage == "start database"]
    assert stages[:1] == [Progress("start database", 0, 20)][:asked]
