"""The command line of proposed contacts: `pinograsp contacts`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

import pinograsp

from ..planning.defaults import PROPOSED
from . import arguments, completion
from .arguments import as_options, command
from .folders import file_name, make_folder, save, save_json
from .inputs import moved, read_robot, scene_words
from .terminal import Terminal


def register(app: typer.Typer) -> None:
    """Add the command."""
    command(
        app,
        "contacts",
        "pinograsp contacts glovebox --object sphere",
        "pinograsp contacts glovebox_can --task can --out out",
    )(contacts)


def contacts(
    scene: arguments.Scene,
    object: Annotated[
        str | None,
        typer.Option("--object", help="Name of an object of the scene.", autocompletion=completion.objects),
    ] = None,
    task: Annotated[
        str | None,
        typer.Option(
            help="In its place, name of a task: its regions, pads and margins count.", autocompletion=completion.tasks
        ),
    ] = None,
    robot: arguments.Robot = arguments.DEFAULT_ROBOT,
    most: Annotated[int, typer.Option(min=1, help="Number of pairs.")] = PROPOSED,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the points that are drawn on the surface.")] = 0,
    object_pose: arguments.ObjectPose = None,
    out: arguments.NoOut = None,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Propose where to touch an object.

    These are pairs of opposite points that the hand can hold where the object stands: a task without desired contacts
    leads its starts to them. Points are in the object's frame. With --out the pairs are written as
    <scene>_<task or object>_<robot>_contacts.json and drawn as .html.
    """
    terminal = Terminal(as_json, quiet)
    described = moved(pinograsp.load_scene(scene), object_pose)
    if out is not None:
        make_folder(out)
    names = {"task, object": "--task, --object", "most": "--most", "seed": "--seed"}
    with terminal.progress() as progress, as_options(names), scene_words(scene, described, task, object_pose):
        model = read_robot(robot)
        found = pinograsp.contacts(model, described, task=task, object=object, seed=seed, most=most, progress=progress)
    thing = object if task is None else described.task(task).object
    content = {
        "robot": model.description.name,
        "scene": described.name,
        "object": thing,
        "task": task,
        "seed": seed,
        "pairs": [pair.to_json() for pair in found],
        "remarks": list(found.remarks),
        "warnings": list(found.warnings),
    }
    saved = [] if out is None else list(_saved(found, content, described, out))
    where = f"{thing}, {model.description.name} in {described.name}"
    terminal.find(lambda: content, lambda: _report(found, where, terminal))
    for line in saved:
        terminal.say(line)


def _saved(
    found: pinograsp.ContactPairs, content: dict[str, Any], scene: pinograsp.Scene, folder: Path
) -> Iterator[str]:
    name = content["task"] or content["object"]
    file = folder / file_name(content["scene"], name, content["robot"], "contacts", suffix="json")
    yield save_json(file, content)
    page = file.with_suffix(".html")
    yield save(page, lambda: pinograsp.visualization.write_contacts_html(found, scene, content["object"], page))


def _report(found: pinograsp.ContactPairs, where: str, terminal: Terminal) -> None:
    from ..tables import Table

    for warning in found.warnings:
        terminal.warn(warning)
    table = Table(f"proposed contacts: {where}")
    table.numbers("", "width\nmm", "first point, object's frame\nmm", "second point\nmm")
    for number, pair in enumerate(found, 1):
        points = ("".join(f"{1e3 * x:8.1f}" for x in point) for point in pair.points)
        table.add(str(number), f"{1e3 * pair.width:.1f}", *points)
    terminal.table(table)
    for remark in found.remarks:
        terminal.say(remark)
