"""The command line of assessments: `pinograsp assess`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import pinograsp

from ..interrupts import exit_code, held
from ..tables import Table
from ..units import shown_in
from . import arguments
from .arguments import as_options, command, given, scaled
from .folders import file_name, make_folder, save_json, saved
from .inputs import grasp_of, read_result, result_words
from .terminal import Terminal

if TYPE_CHECKING:
    from ..assessment.outcome import Sample


def register(app: typer.Typer) -> None:
    """Add the command."""
    command(
        app,
        "assess",
        "pinograsp assess result.json",
        "pinograsp assess result.json --grasp 3 --position 5 --friction 0.5 1.0",
    )(assess)


def assess(
    file: arguments.ResultFile,
    grasp: arguments.GraspNumber = 1,
    samples: Annotated[
        int | None, typer.Option(min=1, help="Sets of errors that are drawn.", show_default="200")
    ] = None,
    position: Annotated[
        float | None, typer.Option(help="Error of the object's position, mm.", show_default="2")
    ] = None,
    orientation: Annotated[
        float | None, typer.Option(help="Error of the object's orientation, degrees.", show_default="2")
    ] = None,
    friction: Annotated[
        tuple[float, float] | None,
        typer.Option(
            metavar="LEAST MOST", help="Coefficients of friction.", show_default="0.8 and 1.2 times the task's"
        ),
    ] = None,
    weight: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="LEAST MOST", help="Factors of the load.", show_default="0.9 and 1.1"),
    ] = None,
    center_of_mass: Annotated[
        float | None, typer.Option(help="Error of the centre of mass, mm.", show_default="2")
    ] = None,
    joint: Annotated[
        float | None,
        typer.Option(help="Error of each arm joint, mrad; of sliding ones, mm.", show_default="1"),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the errors.")] = 0,
    workers: arguments.Workers = None,
    out: arguments.NoOut = None,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Say how much a grasp of a result puts up with.

    The errors are of the object's pose, friction, weight and centre of mass, and of the arm's joints. The hand closes
    again on the displaced object. With --out the assessment is written as
    <scene>_<task>_<robot>_grasp<number>_assessment.json.

    Exit codes: 0 whatever is found, 130 and 143 interrupted.
    """
    terminal = Terminal(as_json, quiet)
    sizes = given(
        position=scaled(1e-3, position),
        orientation=scaled(math.radians(1.0), orientation),
        friction=friction,
        weight=weight,
        center_of_mass=scaled(1e-3, center_of_mass),
        joint=scaled(1e-3, joint),
    )
    as_given = {
        "position": f"--position {position} mm",
        "orientation": f"--orientation {orientation}°",
        "friction": "--friction",
        "weight": "--weight",
        "center_of_mass": f"--center-of-mass {center_of_mass} mm",
        "joint": f"--joint {joint} mrad",
    }
    with as_options(as_given):
        errors = pinograsp.Errors(**sizes)
    result = read_result(file, terminal)
    chosen = grasp_of(result, grasp, file)
    if out is not None:
        make_folder(out)
    named = result_words(file, result)
    with as_options({"samples": "--samples"}), named, terminal.progress() as progress, held():
        found = pinograsp.assess(
            chosen, errors, seed=seed, workers=workers, progress=progress, **given(samples=samples)
        )
        names = {"robot": result.robot, "scene": result.scene, "task": result.task, "number": grasp}
        written = saved(_files(names, found, out))
    terminal.find(lambda: {**names, **found.to_json()}, lambda: _report(found, grasp, result, terminal))
    for line in written:
        terminal.say(line)
    if found.interrupted:
        raise typer.Exit(exit_code())


def _files(names: dict[str, Any], found: pinograsp.Assessment, folder: Path | None) -> Iterator[str]:
    """Write the file if there is a folder for it, and yield what to say of it."""
    if folder is not None:
        parts = (names["scene"], names["task"], names["robot"], f"grasp{names['number']}", "assessment")
        yield save_json(folder / file_name(*parts, suffix="json"), {**names, **found.to_json()})


def _report(found: pinograsp.Assessment, number: int, result: pinograsp.Result, terminal: Terminal) -> None:
    heading = typer.style(f"grasp {number}", bold=True)
    where = f"{result.robot} in {result.scene}, {result.task}"
    if found.samples:
        low, high = (f"{100.0 * end:.1f}" for end in found.interval)
        share = f"{found.holding} of {found.done} samples hold ({100.0 * found.share:.1f} %, 95 %: {low} to {high} %)"
        terminal.say(f"{heading} ({where}): {share}")
    else:
        terminal.say(f"{heading} ({where}): no sample was judged")
    if found.causes:
        terminal.table(_causes(found))
    if found.off_region:
        count = found.off_region
        terminal.say(f"{count} of {found.done} samples touch the object where contact is not allowed")
    if found.worst is not None:
        terminal.paragraph(_worst(found.worst))
    if not found.without_errors.holds:
        terminal.say(f"it fails without errors, too: {found.without_errors.reason}")
    if found.margins:
        terminal.table(_margins(found))
    if found.interrupted:
        terminal.say("interrupted: this is what was done until then")


def _causes(found: pinograsp.Assessment) -> Table:
    table = Table("why samples fail")
    table.words("cause")
    table.numbers("samples")
    for cause, count in found.causes.items():
        table.add(cause, str(count))
    return table


def _margins(found: pinograsp.Assessment) -> Table:
    table = Table("how large each error may be, alone")
    table.words("error")
    table.numbers("holds")
    table.words("ends", "because")
    for margin in found.margins:
        table.add(margin.kind, _size(margin), margin.where, margin.cause)
    return table


def _size(margin: pinograsp.Margin) -> str:
    """Return what a margin says, in the units of tables."""
    factor, unit = shown_in(margin.unit)
    size = f"{factor * margin.size:.3g} {unit}".rstrip()
    match margin.kind, margin.capped:
        case "friction", capped:
            return "without any" if capped else f"from {size}"
        case "weight", capped:
            size = f"{size} times"
        case _, capped:
            pass
    return f"{size} and more" if capped else f"up to {size}"


def _worst(worst: Sample) -> str:
    """Return the line about the worst sample, lengths in mm and angles in degrees."""
    draw, verdict = worst.errors, worst.verdict
    balance = "nothing balances the load" if verdict.margin == -math.inf else f"{verdict.margin:.3g} N to spare"
    outcome = "holds" if verdict.holds else f"fails, {verdict.reason}"
    vectors = (
        ("position", 1e3 * draw.position, "mm"),
        ("orientation", [math.degrees(angle) for angle in draw.orientation], "°"),
        ("centre of mass", 1e3 * draw.center_of_mass, "mm"),
        ("joints", [math.degrees(angle) for angle in draw.joints], "°"),
    )
    parts = [f"{name} {' '.join(f'{value:.2f}' for value in values)} {unit}" for name, values, unit in vectors]
    parts += [f"friction {draw.friction:.3f}", f"weight {draw.weight:.3f}"]
    return f"least margin of balance: sample {worst.number} {outcome}; {balance}; {', '.join(parts)}"
