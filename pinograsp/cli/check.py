"""The command line of own configurations: `pinograsp check`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer

import pinograsp

from ..disk import is_file, json_of
from ..errors import InputError
from . import arguments
from .arguments import as_options, command, named_values
from .folders import file_name, make_folder, save, save_json, saved
from .inputs import read_robot, read_scene, scene_words
from .terminal import Terminal

NOT_VERIFIED = 1


def register(app: typer.Typer) -> None:
    """Add the command."""
    command(
        app,
        "check",
        "pinograsp check glovebox --task sphere --joints posture.json",
        "pinograsp check glovebox --task sphere --joints posture.json \\",
        "    --joints elbow=0.5 --out out",
    )(check)


def check(
    scene: arguments.Scene,
    task: arguments.Task,
    joints: Annotated[
        list[str],
        typer.Option(
            metavar="FILE|JOINT=VALUE",
            help="Arm joints and synergies, rad (m): a JSON file of values by name, or values; can be repeated, later "
            "values count.",
        ),
    ],
    robot: arguments.Robot = arguments.DEFAULT_ROBOT,
    lock: arguments.Locks = None,
    object_pose: arguments.ObjectPose = None,
    out: arguments.NoOut = None,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Check a configuration of your own.

    The independent check gives every figure of a certificate, and the distances below 50 mm pair by pair. Pads and
    object are taken to touch where they are nearest, with the best contact forces there. With --out the check is
    written as <scene>_<task>_<robot>_check.json and .html.

    Exit codes: 0 it is a verified grasp, 1 it is not.
    """
    terminal = Terminal(as_json, quiet)
    described, values = read_scene(scene, task, object_pose, lock), read_joints(joints)
    if out is not None:
        make_folder(out)
    with terminal.progress() as progress, scene_words(scene, described, task, object_pose, lock):
        model = read_robot(robot)
        name = model.description.name
        planner = pinograsp.Planner(model, described, workers=1, progress=progress)
        with planner, as_options({"joints": "--joints"}):
            found = planner.check(task, values)
        names = {"robot": name, "scene": described.name, "task": task}
        written = saved(_files(names, found, out))
    where = f"{task}, {name} in {described.name}"
    terminal.find(lambda: {**names, **found.to_json()}, lambda: _report(found, where, terminal))
    for line in written:
        terminal.say(line)
    if not found.verified:
        raise typer.Exit(NOT_VERIFIED)


def read_joints(texts: Sequence[str]) -> dict[str, float]:
    """Return values by name from JSON files and from texts such as `elbow=0.5`.

    Raises:
        InputError: a file cannot be read or does not hold numbers by name, or a text cannot be understood.
    """
    found: dict[str, float] = {}
    for text in texts:
        found |= named_values([text], "--joints") if _is_value(text) else _of_file(Path(text))
    return found


def _is_value(text: str) -> bool:
    """Return whether a text is JOINT=VALUE: files and their folders may have equals signs in their names."""
    return "=" in text and Path(text).name == text and not is_file(Path(text))


def _of_file(file: Path) -> dict[str, float]:
    content = json_of(file)
    if isinstance(content, dict) and "grasps" in content:
        remedy = "pinograsp show RESULT --json gives one that --joints takes"
        raise InputError("is a result: one grasp is wanted", file=file, key="--joints", remedy=remedy)
    if isinstance(content, dict) and isinstance(content.get("grasp"), dict):  # what `show --json` says of a grasp
        content = content["grasp"]
    if isinstance(content, dict) and isinstance(content.get("joints"), dict):  # a grasp
        content = content["joints"]
    if not isinstance(content, dict):
        remedy = 'Write, for example, {"shoulder": 0.5, "elbow": -0.3}'
        raise InputError("values by the names of joints are wanted", file=file, key="--joints", remedy=remedy)
    for name, value in content.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"a number is wanted, not {json.dumps(value)}", file=file, key=name)
    return {name: float(value) for name, value in content.items()}


def _files(names: dict[str, str], found: pinograsp.ConfigurationCheck, folder: Path | None) -> Iterator[str]:
    """Write the files if there is a folder for them, and yield what to say of each."""
    if folder is None:
        return
    file = folder / file_name(names["scene"], names["task"], names["robot"], "check", suffix="json")
    yield save_json(file, {**names, **found.to_json()})
    page = file.with_suffix(".html")
    yield save(page, lambda: pinograsp.visualization.write_html(found, page))


def _report(found: pinograsp.ConfigurationCheck, where: str, terminal: Terminal) -> None:
    from ..results.table import clearances_table, figures_table

    for warning in found.warnings:
        terminal.warn(warning)
    terminal.table(figures_table(found.certificate.figures, f"certificate: {where}"))
    if found.clearances:
        terminal.say("")
        terminal.table(clearances_table(found.clearances, "distances below 50 mm"))
    terminal.say("")
    refuted = found.certificate.refuted_by
    verdict = "verified" if found.verified else f"not verified: {', '.join(figure.name for figure in refuted)}"
    terminal.say(typer.style(verdict, bold=True, fg="green" if found.verified else "red"))
