"""Words that a shell completes: quickly, and nothing where something is wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import typer

import pinograsp


def robots(incomplete: str) -> list[str]:
    """Return shipped robots, robot files and folders."""
    return _words(lambda: [*pinograsp.shipped_robots(), *_files(incomplete, ".yaml")])


def scenes(incomplete: str) -> list[str]:
    """Return shipped scenes and scene files."""
    return _words(lambda: [*pinograsp.shipped_scenes(), *_files(incomplete, ".yaml")])


def tasks(context: typer.Context, incomplete: str) -> list[str]:
    """Return the tasks of the scene that stands in the line before."""
    del incomplete
    return _words(lambda: _scene(context).tasks)


def objects(context: typer.Context, incomplete: str) -> list[str]:
    """Return the objects of the scene that stands in the line before."""
    del incomplete
    return _words(lambda: _scene(context).objects)


def criteria(incomplete: str) -> list[str]:
    """Return what grasps can be ordered by."""
    del incomplete
    return _words(lambda: ["score", *(criterion.name for criterion in pinograsp.CRITERIA)])


def _scene(context: typer.Context) -> pinograsp.Scene:
    # An option that waits for its value keeps arguments from being told apart: they are what is left over.
    return pinograsp.load_scene(context.params.get("scene") or context.args[0])


def _files(incomplete: str, suffix: str) -> list[str]:
    """Return the files with a suffix, and the folders, that begin so."""
    folder, _, start = incomplete.rpartition("/")
    place = Path(folder or ("/" if incomplete.startswith("/") else "."))
    there = [entry for entry in place.iterdir() if entry.name.startswith(start) and not entry.name.startswith(".")]
    before = f"{folder}/" if "/" in incomplete else ""
    return [
        f"{before}{entry.name}{'/' * entry.is_dir()}"
        for entry in sorted(there)
        if entry.is_dir() or entry.suffix == suffix
    ]


def _words(found: Callable[[], Iterable[str]]) -> list[str]:
    try:
        return list(found())
    except Exception:  # whatever it is: a shell that completes is no place for errors
        return []
