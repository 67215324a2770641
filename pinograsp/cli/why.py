"""The command line of explanations: `pinograsp why`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

import pinograsp

from ..interrupts import asked_to_end, exit_code, held
from ..planning.defaults import EXPLAIN_SECONDS, EXPLAINED
from . import arguments
from .arguments import as_options, command, given
from .folders import file_name, make_folder, remove, save, save_json, saved
from .inputs import read_robot, read_scene, scene_words
from .terminal import Terminal

NOTHING_HELPS = 1


def register(app: typer.Typer) -> None:
    """Add the command."""
    command(
        app,
        "why",
        "pinograsp why my_scene.yaml --task can",
        "pinograsp why my_scene.yaml --task can --deadline 120 --out out",
    )(why)


def why(
    scene: arguments.Scene,
    task: arguments.Task,
    robot: arguments.Robot = arguments.DEFAULT_ROBOT,
    starts: Annotated[
        int | None,
        typer.Option(min=1, help="Starts of the plan that is explained.", show_default=str(EXPLAINED)),
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of the choice of starts.", show_default="0")] = None,
    deadline: Annotated[
        float | None,
        typer.Option(
            min=0.0, metavar="SECONDS", help="Time for remedies, after the plan.", show_default=f"{EXPLAIN_SECONDS:g}"
        ),
    ] = None,
    workers: arguments.Workers = None,
    lock: arguments.Locks = None,
    object_pose: arguments.ObjectPose = None,
    database: Annotated[
        Path | None, typer.Option(help="Start database.", show_default="a small one, built once in the cache folder")
    ] = None,
    out: arguments.NoOut = None,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Say why a task finds no grasp, and what would help.

    What kept how many starts from a grasp, the posture that came nearest to one, and remedies: the least changes that
    make the task work, each found and verified by planning again. With --out the explanation is written as
    <scene>_<task>_<robot>_why.json, and the nearest miss as a page.

    Exit codes: 0 the task works, or a remedy was found, 1 nothing that was tried helps, 130 and 143 interrupted.
    """
    terminal = Terminal(as_json, quiet)
    described = read_scene(scene, task, object_pose, lock)
    if out is not None:
        make_folder(out)
    names = {name: f"--{name}" for name in ("starts", "seed", "deadline", "workers")}
    with terminal.progress() as progress, as_options(names), scene_words(scene, described, task, object_pose, lock):
        model = read_robot(robot)
        with held():
            found = pinograsp.explain(
                model,
                described,
                task,
                workers=workers,
                database=database,
                progress=progress,
                **given(starts=starts, seed=seed, deadline=deadline),
            )
            names = {"robot": model.description.name, "scene": described.name, "task": task}
            written = saved(_files(names, found, out))
    terminal.find(lambda: {**names, **found.to_json()}, lambda: _report(found, terminal))
    for line in written:
        terminal.say(line)
    if asked_to_end():
        raise typer.Exit(exit_code())
    if not (found.verified or found.remedies):
        raise typer.Exit(NOTHING_HELPS)


def _files(names: dict[str, str], found: pinograsp.Explanation, folder: Path | None) -> Iterator[str]:
    """Write the files if there is a folder for them, and yield what to say of each."""
    if folder is None:
        return
    file = folder / file_name(names["scene"], names["task"], names["robot"], "why", suffix="json")
    yield save_json(file, {**names, **found.to_json()})
    page = file.with_suffix(".html")
    if found.nearest_miss is None:  # one that is there shows the posture of a file that is no more
        yield from remove(page)
    else:
        yield save(page, lambda: pinograsp.visualization.write_html(found, page))


def _report(found: pinograsp.Explanation, terminal: Terminal) -> None:
    from ..results.table import explanation_lines

    for warning in found.warnings:
        terminal.warn(warning)
    for line in explanation_lines(found):
        terminal.paragraph(line)
    terminal.say(f"{found.seconds:.1f} s in all")
