"""Outcomes of commands that a fault has reached: each is named, or wrong."""

from __future__ import annotations

import re
import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import duckdb

import pinograsp
from faults_machine import (
    NAME,
    SAID,
    Done,
    WrongError,
    require_clean,
)


def check_plan(folder: Path, done: Done, number: int | None, whole: Any) -> str:
    """Return the outcome of a plan that a signal of a number, or nothing, has reached."""
    file = folder / "out" / f"{NAME}.json"
    if number == signal.SIGKILL:
        if file.exists():
            pinograsp.read_json(file)
        return "killed" if done.code < 0 else "was done"
    if _not_begun(folder, done, number):
        return "not begun"
    done.require(0, *([SAID[number]] if number else []))
    require_clean(folder)
    if done.code == 0:
        require_same(file, whole)
        return "was done"
    reported = [int(n) for n in re.findall(r"starts: (\d+) of", done.errors)]
    if not file.exists():
        if reported or "error: interrupted" not in done.errors:
            raise WrongError(f"nothing written: {done.output}{done.errors}")
        return "nothing to keep"
    result = pinograsp.read_json(file)
    if max(reported, default=0) > result.done or sum(g.count for g in result.grasps) != result.verified:
        raise WrongError(f"{result.done} starts, {result.verified} verified are kept of {reported}")
    if not result.interrupted:
        require_same(file, whole)
    return "kept" if result.interrupted else "was done"


def require_same(file: Path, whole: Any) -> None:
    """Refuse a result with other grasps than those found without a fault."""
    grasps = [grasp.to_json() for grasp in pinograsp.read_json(file).grasps]
    if grasps != whole:
        raise WrongError(f"{len(grasps)} grasps, {len(whole)} without the fault, and not the same")


def _not_begun(folder: Path, done: Done, number: int | None) -> bool:
    """Whether the system ended a command, in the 2 ms in which it imports what sees to signals: shells say 143, too."""
    return done.code == -(number or 0) != 0 and not (done.output or done.errors or (folder / "out").exists())


def _interrupted(folder: Path, done: Done, number: int | None, kept: str) -> str:
    """Return the outcome of a command that went on to its end, or ended with one line, and left nothing lying about."""
    if _not_begun(folder, done, number):
        return "not begun"
    done.require(0, *([SAID[number]] if number else []))
    require_clean(folder)
    if done.code and done.errors.count("error: interrupted") != 1:
        raise WrongError(done.errors)
    return kept if done.code else "was done"


def check_build(folder: Path, done: Done, number: int | None, whole: Any) -> str:
    """Return the outcome of a build; the same command goes on."""
    if number == signal.SIGKILL:
        return "killed" if done.code < 0 else "was done"
    return _interrupted(folder, done, number, "kept")


def check_report(folder: Path, done: Done, number: int | None, whole: Any) -> str:
    """Return the outcome of a page, which is there whole or not at all."""
    pages = list((folder / "out").glob("*.html"))
    if not all(page.read_text().endswith(whole) for page in pages):
        raise WrongError("the page is not whole")
    if number == signal.SIGKILL:
        return "killed" if done.code < 0 else "was done"
    return _interrupted(folder, done, number, "interrupted")


def rows_of(file: Path) -> Any:
    """Return the number of rows of a database, and a sum that tells them apart."""
    with duckdb.connect(str(file), read_only=True) as connection:
        found = connection.execute("SELECT count(*), sum(hash(sample, q1, x, clearance)) FROM configurations")
        return found.fetchone()


@dataclass
class Subject:
    """A command that faults reach."""

    words: tuple[object, ...]
    check: Callable[[Path, Done, int | None, Any], str]
    whole: Any = None
    seconds: float = 0.0
