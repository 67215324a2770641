"""The command line of assessments: `pinograsp assess`."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Annotated

import typer
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress
from rich.table import Table

from ..assessment.assess import assess
from ..assessment.errors import SAMPLES, Errors
from ..assessment.outcome import Assessment, Margin
from ..disk import write_whole
from ..results import Result, read_json
from ..results.units import shown_in
from .chosen import chosen_grasp
from .console import say
from .folders import make_folder

INTERRUPTED = 130
DEFAULT = Errors()
GRASP_HELP = "Number of the grasp in the file's order, from 1."


def assess_command(
    file: Annotated[Path, typer.Argument(help="JSON file of a result.")],
    grasp: Annotated[int, typer.Option(help=GRASP_HELP)] = 1,
    samples: Annotated[int, typer.Option(min=1, help="Sets of errors that are drawn.")] = SAMPLES,
    position: Annotated[float, typer.Option(help="Error of the object's position, mm.")] = 1e3 * DEFAULT.position,
    orientation: Annotated[float, typer.Option(help="Error of the object's orientation, degrees.")] = math.degrees(
        DEFAULT.orientation
    ),
    friction: Annotated[
        tuple[float, float] | None,
        typer.Option(help="Least and greatest friction; by default 0.8 and 1.2 times the task's."),
    ] = None,
    weight: Annotated[
        tuple[float, float], typer.Option(help="Least and greatest factor of the load.")
    ] = DEFAULT.weight,
    center_of_mass: Annotated[float, typer.Option(help="Error of the centre of mass, mm.")] = 1e3
    * DEFAULT.center_of_mass,
    joint: Annotated[
        float,
        typer.Option(help="Error of each arm joint, degrees (of sliding ones 17.5 mm a degree).", show_default="0.057"),
    ] = math.degrees(DEFAULT.joint),
    seed: Annotated[int, typer.Option(min=0, help="Seed of the errors.")] = 0,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; by default one for each core.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="JSON file to write.")] = None,
) -> None:
    """Say how much a grasp of a result puts up with: errors of pose, friction, weight, centre of mass and joints.

    The hand closes again on the displaced object. Exits with 0 whatever is found; 130 if it was interrupted.
    """
    console = Console()
    errors = Errors(
        position=1e-3 * position,
        orientation=math.radians(orientation),
        friction=friction,
        weight=weight,
        center_of_mass=1e-3 * center_of_mass,
        joint=math.radians(joint),
    )
    result = read_json(file)
    chosen = chosen_grasp(result, grasp, file)
    if json_file is not None:
        make_folder(json_file.parent)  # before the work, not after it
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        row = bar.add_task("samples and margins", total=None)

        def progress(done: int, total: int) -> None:
            bar.update(row, completed=done, total=total)

        found = assess(chosen, errors, samples=samples, seed=seed, workers=workers, progress=progress)
    _report(found, grasp, result, console)
    if json_file is not None:
        content = {"robot": result.robot, "scene": result.scene, "task": result.task, "grasp": grasp, **found.to_json()}
        write_whole(json_file, json.dumps(content, indent=1, allow_nan=False) + "\n")
        say(console, f"written: {escape(str(json_file))}")
    if found.interrupted:
        raise typer.Exit(INTERRUPTED)


def _report(found: Assessment, number: int, result: Result, console: Console) -> None:
    where = escape(f"{result.robot} in {result.scene}, {result.task}")
    if found.samples:
        low, high = (f"{100.0 * end:.1f}" for end in found.interval)
        share = f"{found.holding} of {found.done} samples hold ({100.0 * found.share:.1f} %, 95 %: {low} to {high} %)"
        say(console, f"[bold]grasp {number}[/] ({where}): {share}")
    else:
        say(console, f"[bold]grasp {number}[/] ({where}): no sample was judged")
    if found.causes:
        console.print(_causes(found))
    if found.off_region:
        count = found.off_region
        say(console, f"{count} of {found.done} samples touch the object where contact is not allowed")
    if found.worst is not None:
        say(console, escape(_worst(found)))
    if not found.without_errors.holds:
        say(console, f"[yellow]it fails without errors, too:[/] {escape(found.without_errors.reason)}")
    if found.margins:
        console.print(_margins(found))
    if found.interrupted:
        say(console, "[yellow]interrupted[/]: this is what was done until then")


def _table(title: str) -> Table:
    return Table(
        title=title, title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False, pad_edge=False
    )


def _causes(found: Assessment) -> Table:
    table = _table("why samples fail")
    table.add_column("cause")
    table.add_column("samples", justify="right")
    for cause, count in found.causes.items():
        table.add_row(cause, str(count))
    return table


def _margins(found: Assessment) -> Table:
    table = _table("how large each error may be, alone")
    for column in ("error", "holds", "ends", "because"):
        table.add_column(column, justify="right" if column == "holds" else "left")
    for margin in found.margins:
        table.add_row(margin.kind, _size(margin), escape(margin.where), escape(margin.cause))
    return table


def _size(margin: Margin) -> str:
    """Return what a margin says, in the units of the command line."""
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


def _worst(found: Assessment) -> str:
    """Return the line about the worst sample, lengths in mm and angles in degrees."""
    worst = found.worst
    assert worst is not None
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
