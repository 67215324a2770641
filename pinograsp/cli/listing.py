"""The command line of what comes along: `pinograsp list` and `pinograsp schema`."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

import typer

import pinograsp

from . import arguments
from .arguments import command
from .terminal import Terminal


def register(app: typer.Typer) -> None:
    """Add the commands."""
    command(app, "list", "pinograsp list", "pinograsp list --json")(list_shipped)
    command(app, "schema", "pinograsp schema scene > scene.schema.json")(schema)


def list_shipped(as_json: arguments.Json = False, quiet: arguments.Quiet = False) -> None:
    """List the robots, scenes and tasks that come with pinograsp."""
    terminal = Terminal(as_json, quiet)
    content = _content()
    terminal.find(lambda: content, lambda: _report(content, terminal))


def schema(
    kind: Annotated[Literal["robot", "scene"], typer.Argument(metavar="robot|scene", help="Kind of file.")],
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Print the JSON Schema of robot or scene files.

    Editors complete and check files with it. It is a JSON document with --json and without.
    """
    terminal = Terminal(as_json, quiet)
    content = pinograsp.schema(kind)
    terminal.find(lambda: content, lambda: terminal.say(json.dumps(content, indent=1)))


def _content() -> dict[str, list[dict[str, Any]]]:
    from ..descriptions import load_robot_description

    robots, scenes = [], []
    for name, file in pinograsp.shipped_robots().items():
        robots.append({"name": name, "description": load_robot_description(file).description, "file": str(file)})
    for name, file in pinograsp.shipped_scenes().items():
        scene = pinograsp.load_scene(file)
        tasks = list(scene.tasks)
        scenes.append({"name": name, "description": scene.description, "file": str(file), "tasks": tasks})
    return {"robots": robots, "scenes": scenes}


def _report(content: dict[str, list[dict[str, Any]]], terminal: Terminal) -> None:
    for robot in content["robots"]:
        terminal.paragraph(f"robot {robot['name']}: {robot['description']}")
    for scene in content["scenes"]:
        terminal.paragraph(f"scene {scene['name']}: {scene['description']}; tasks: {', '.join(scene['tasks'])}")
