"""The command line of written results: `pinograsp verify`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import typer

import pinograsp

from . import arguments
from .arguments import command
from .inputs import read_result, result_words
from .terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Sequence

DIFFERENT = 1


def register(app: typer.Typer) -> None:
    """Add the command."""
    command(app, "verify", "pinograsp verify result.json")(verify)


def verify(
    file: arguments.ResultFile,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Recompute every certificate of a result.

    Nothing but its file is used, and the URDF and meshes that the robot names; what differs is listed.

    Exit codes: 0 every certificate stands (or there is none), 1 something differs.
    """
    terminal = Terminal(as_json, quiet)
    result = read_result(file, terminal)
    with terminal.progress() as progress, result_words(file, result):
        found = pinograsp.verify(result, progress)
    terminal.find(lambda: _document(result, found), lambda: _report(len(result.grasps), found, terminal))
    if found:
        raise typer.Exit(DIFFERENT)


def _document(result: pinograsp.Result, found: Sequence[pinograsp.Difference]) -> dict[str, object]:
    names = {"robot": result.robot, "scene": result.scene, "task": result.task}
    return {**names, "grasps": len(result.grasps), "differences": [difference.to_json() for difference in found]}


def _report(count: int, found: Sequence[pinograsp.Difference], terminal: Terminal) -> None:
    for difference in found:
        whose = "result" if difference.grasp is None else f"grasp {difference.grasp}"
        data = difference.to_json()
        stated, recomputed = json.dumps(data["stated"]), json.dumps(data["recomputed"])
        terminal.say(f"{whose}: {difference.what}: {stated} stated, {recomputed} recomputed")
    grasps = f"{count} {'grasp' if count == 1 else 'grasps'} recomputed"
    if found:
        differences = f"{len(found)} {'difference' if len(found) == 1 else 'differences'}"
        terminal.say(typer.style(f"{grasps}: {differences}", bold=True, fg="red"))
    elif count:
        terminal.say(f"{grasps}: every certificate stands")
    else:
        terminal.say("the result has no grasp, so no certificate was recomputed; the rest of it stands")
