"""The command line of the hold test: `pinograsp hold`."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

import pinograsp

from ..hold.options import HoldOptions
from ..interrupts import exit_code, held
from ..tables import Table
from . import arguments
from .arguments import as_options, command, given, scaled
from .folders import file_name, make_folder, save, save_json, saved
from .inputs import grasp_of, read_result, result_words
from .terminal import Terminal

NOT_HELD = 1
BEST = 20
"""Grasps that are tested where nothing else is asked for."""
COARSE = 5e-4
"""From which distance on it is said that convex pieces stand off an object where pads touch, m."""


def register(app: typer.Typer) -> None:
    """Add the command."""
    command(
        app,
        "hold",
        "pinograsp hold result.json --best 5",
        "pinograsp hold result.json --grasp 3 --first-slip --film --out out",
    )(hold)


def hold(
    file: arguments.ResultFile,
    best: Annotated[
        int | None, typer.Option(min=1, help="How many grasps, from the best on.", show_default=str(BEST))
    ] = None,
    grasp: Annotated[
        int | None, typer.Option(min=1, metavar="NUMBER", help="The one grasp to test, by its number, from 1.")
    ] = None,
    first_slip: Annotated[bool, typer.Option("--first-slip", help="Find the acceleration of first slip.")] = False,
    controls: Annotated[bool, typer.Option("--controls", help="Run the negative controls: both must drop it.")] = False,
    acceleration: Annotated[float, typer.Option(help="Of the shakes, m/s^2.")] = HoldOptions.acceleration,
    spin: Annotated[float, typer.Option(help="Angular acceleration of the spins, rad/s^2.")] = HoldOptions.spin,
    slip_distance: Annotated[
        float | None, typer.Option(help="Displacement from which on it is not held, mm.", show_default="1")
    ] = None,
    slip_angle: Annotated[
        float | None, typer.Option(help="Rotation from which on it is not held, degrees.", show_default="2")
    ] = None,
    ramp: Annotated[
        float, typer.Option(help="Growth of the acceleration up to the first slip, m/s^2 per second.")
    ] = HoldOptions.ramp,
    strongest: Annotated[
        float, typer.Option(help="Acceleration at which the search for it ends, m/s^2.")
    ] = HoldOptions.strongest,
    control: Annotated[
        str,
        typer.Option(
            help="torque of the driver, position of the joints, or auto: torque for hands of one synergy, position for "
            "others."
        ),
    ] = HoldOptions.control,
    squeeze: Annotated[bool, typer.Option(help="Whether the hand squeezes.")] = HoldOptions.squeeze,
    friction: Annotated[
        float | None, typer.Option(help="Friction coefficient.", show_default="that of the task")
    ] = None,
    mjcf: Annotated[bool, typer.Option("--mjcf", help="Write the model of the first one for MuJoCo's viewer.")] = False,
    film: Annotated[bool, typer.Option("--film", help="Write a film of the first one.")] = False,
    workers: arguments.Workers = None,
    out: arguments.NoOut = None,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Simulate grasps of a result in MuJoCo.

    Each is held at rest, shaken along and turned about every axis of the world. With --out the outcomes are written as
    <scene>_<task>_<robot>_hold.json; model and film of the first grasp that is tested as
    <scene>_<task>_<robot>_grasp<number>.xml and .gif.

    Exit codes: 0 every grasp holds (and every control drops the object), 1 one does not, 130 and 143 interrupted.
    """
    terminal = Terminal(as_json, quiet)
    values: dict[str, Any] = given(
        acceleration=acceleration,
        spin=spin,
        slip_distance=scaled(1e-3, slip_distance),
        slip_angle=scaled(math.radians(1.0), slip_angle),
        ramp=ramp,
        strongest=strongest,
        control=control,
        friction=friction,
    )
    as_given = {
        **{name: f"--{name}" for name in values},
        "slip_distance": f"--slip-distance {slip_distance} mm",
        "slip_angle": f"--slip-angle {slip_angle}°",
    }
    with as_options(as_given):
        options = HoldOptions(**values, squeeze=squeeze, first_slip=first_slip, controls=controls)
    _require_fitting(best, grasp, {"--mjcf": mjcf, "--film": film}, out)
    result = read_result(file, terminal)
    grasps, first = _chosen(result, file, best, grasp)
    if out is not None:
        make_folder(out)
    with terminal.progress() as progress, result_words(file, result), held():
        tested = pinograsp.hold_test(grasps, None, workers=workers, options=options, progress=progress)
        outcomes = [dataclasses.replace(outcome, grasp=outcome.grasp + first - 1) for outcome in tested]
        written = saved(_files(result, outcomes, out))
    terminal.find(lambda: _document(result, outcomes), lambda: _report(outcomes, options, terminal))
    for line in written:
        terminal.say(line)
    if len(outcomes) < len(grasps):
        raise typer.Exit(exit_code())
    if out is not None:
        names = (result.scene, result.task, result.robot, f"grasp{first}")
        if mjcf:
            _write_model(grasps[0], options, out / file_name(*names, suffix="xml"), terminal)
        if film:
            _write_film(grasps[0], options, out / file_name(*names, suffix="gif"), terminal)
    if not all(outcome.held and not any(outcome.controls.values()) for outcome in outcomes):
        raise typer.Exit(NOT_HELD)


def _require_fitting(best: int | None, grasp: int | None, files: dict[str, bool], out: Path | None) -> None:
    """Refuse options that do not go together, and files of some options without a folder."""
    if best is not None and grasp is not None:
        raise pinograsp.InputError("is given with --best", key="--grasp", remedy="Give one of them")
    for key, wanted in files.items():
        if wanted and out is None:
            raise pinograsp.InputError("is a file to write", key=key, remedy="Give its folder with --out")


def _write_model(grasp: pinograsp.Grasp, options: HoldOptions, file: Path, terminal: Terminal) -> None:
    terminal.say(save(file, lambda: pinograsp.write_mjcf(grasp, file, options)))


def _write_film(grasp: pinograsp.Grasp, options: HoldOptions, file: Path, terminal: Terminal) -> None:
    with terminal.progress() as progress:
        drawn = save(file, lambda: pinograsp.write_film(grasp, file, options, progress=progress))
    terminal.say(drawn)


def _chosen(
    result: pinograsp.Result, file: Path, best: int | None, number: int | None
) -> tuple[Sequence[pinograsp.Grasp], int]:
    """Return the grasps to test and the number of the first one."""
    if number is not None:
        return [grasp_of(result, number, file)], number
    if not result.grasps:
        raise pinograsp.InputError("holds no grasp", file=file)
    return result.grasps[: best or BEST], 1


def _files(result: pinograsp.Result, outcomes: Sequence[pinograsp.HoldOutcome], folder: Path | None) -> Iterator[str]:
    """Write the file of the outcomes if there is a folder for it, and yield what to say of it."""
    if folder is not None:
        file = folder / file_name(result.scene, result.task, result.robot, "hold", suffix="json")
        yield save_json(file, _document(result, outcomes))


def _document(result: pinograsp.Result, outcomes: Sequence[pinograsp.HoldOutcome]) -> dict[str, object]:
    names = {"scene": result.scene, "task": result.task, "robot": result.robot}
    return {**names, "outcomes": [outcome.to_json() for outcome in outcomes]}


def _report(outcomes: Sequence[pinograsp.HoldOutcome], options: HoldOptions, terminal: Terminal) -> None:
    if not outcomes:
        terminal.say("interrupted before the first outcome: nothing is known of any grasp")
        return
    terminal.table(_table(outcomes, options))
    for line in _lines(outcomes, options):
        terminal.say(line)


def _table(outcomes: Sequence[pinograsp.HoldOutcome], options: HoldOptions) -> Table:
    """Return a table of outcomes; of each grasp the forces of its pads, the planned ones below the measured ones."""
    table = Table("forces of the pads at rest in N: in the simulation, and below as planned")
    table.numbers("", "held", "moved\nmm", "turned\n°", "pads\nN")
    if options.first_slip:
        table.numbers("slips\nm/s²")
    for outcome in outcomes:
        forces = [(pad.measured, pad.planned) for pad in outcome.pads]
        rows = ("".join(f"{force:6.2f}" for force in row) for row in zip(*forces, strict=True))
        slip = [_slip(outcome)] if options.first_slip else []
        moved, turned = f"{1e3 * outcome.distance:.3f}", f"{math.degrees(outcome.angle):.2f}"
        table.add(str(outcome.grasp), "yes" if outcome.held else "no", moved, turned, "\n".join(rows), *slip)
    return table


def _slip(outcome: pinograsp.HoldOutcome) -> str:
    slip = outcome.first_slip
    if slip is None:
        return "-"
    return f"{slip.acceleration:.1f} {slip.direction}" if slip.slipped else f"> {slip.acceleration:.0f}"


def _lines(outcomes: Sequence[pinograsp.HoldOutcome], options: HoldOptions) -> list[str]:
    held = sum(outcome.held for outcome in outcomes)
    lines = [
        f"{held} of {len(outcomes)} grasps hold at rest, shaken with {options.acceleration:g} m/s² and turned with "
        f"{options.spin:g} rad/s²"
    ]
    lost = [outcome for outcome in outcomes if not outcome.held]
    lines += [f"grasp {outcome.grasp} does not: {', '.join(outcome.failed)}" for outcome in lost]
    for link in sorted({link for outcome in outcomes for link in outcome.touching}):
        touched = [str(outcome.grasp) for outcome in outcomes if link in outcome.touching]
        lines.append(f"{link} touches the object other than with a pad: grasp {', '.join(touched)}")
    for outcome in outcomes:
        if outcome.standoff > COARSE:
            off = f"{1e3 * outcome.standoff:.1f} mm off it where pads touch: this proves nothing of the object itself"
            lines.append(f"grasp {outcome.grasp}: the convex pieces that stand for the object are {off}")
    for name in outcomes[0].controls:
        holding = [str(outcome.grasp) for outcome in outcomes if outcome.controls[name]]
        said = f"holds with grasp {', '.join(holding)}: the test proves nothing" if holding else "drops every object"
        lines.append(f"control with {name}: {said}")
    return lines
