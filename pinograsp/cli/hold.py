"""The command line of the hold test: `pinograsp hold`."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress
from rich.table import Table

from ..errors import InputError
from ..hold.film import film_file, write_film
from ..hold.options import HoldOptions
from ..hold.outcome import HoldOutcome
from ..hold.run import HoldProgress, hold_test
from ..hold.write import write_mjcf
from ..results import Grasp, read_json
from .chosen import chosen_grasp
from .console import say

NOT_HELD, INTERRUPTED = 1, 130


def hold_command(
    file: Annotated[Path, typer.Argument(help="JSON file of a result.")],
    best: Annotated[int, typer.Option(min=1, help="How many grasps, from the best on.")] = 20,
    grasp: Annotated[int | None, typer.Option(min=1, help="Number of the one grasp to test, from 1.")] = None,
    first_slip: Annotated[bool, typer.Option("--first-slip", help="Find the acceleration of first slip.")] = False,
    controls: Annotated[bool, typer.Option("--controls", help="Run the negative controls: both must drop it.")] = False,
    acceleration: Annotated[float, typer.Option(help="Of the shakes, m/s^2.")] = 5.0,
    spin: Annotated[float, typer.Option(help="Angular acceleration of the spins, rad/s^2.")] = 10.0,
    mjcf: Annotated[Path | None, typer.Option(help="Write the model of the (best) grasp for MuJoCo's viewer.")] = None,
    film: Annotated[Path | None, typer.Option(help="Write a film of the (best) grasp, a .gif.")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; by default one for each core.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the outcomes as JSON.")] = False,
) -> None:
    """Simulate grasps in MuJoCo: at rest, shaken along and turned about every axis of the world.

    Exits with 0 if every grasp holds (and every control drops the object), 1 if not.
    """
    console = Console()
    options = HoldOptions(acceleration=acceleration, spin=spin, first_slip=first_slip, controls=controls)
    if film is not None:
        film_file(film)  # before the work, not after it
    grasps, first = _chosen(file, best, grasp)
    outcomes = _tested(grasps, first, options, workers, console)
    if as_json:
        typer.echo(json.dumps([dataclasses.asdict(outcome) for outcome in outcomes], indent=1))
    else:
        console.print(_table(outcomes, options))
        for line in _lines(outcomes, options):
            say(console, escape(line))
    if len(outcomes) < len(grasps):
        raise typer.Exit(INTERRUPTED)
    for written, write in ((mjcf, write_mjcf), (film, write_film)):
        if written is not None:
            write(grasps[0], written, options)
            say(Console(stderr=as_json), f"written: {escape(str(written))}")
    if not all(outcome.held and not any(outcome.controls.values()) for outcome in outcomes):
        raise typer.Exit(NOT_HELD)


def _chosen(file: Path, best: int, number: int | None) -> tuple[Sequence[Grasp], int]:
    """Return the grasps to test and the number of the first one."""
    result = read_json(file)
    if number is not None:
        return [chosen_grasp(result, number, file)], number
    if not result.grasps:
        raise InputError("holds no grasp", file=file)
    return result.grasps[:best], 1


def _tested(
    grasps: Sequence[Grasp], first: int, options: HoldOptions, workers: int | None, console: Console
) -> list[HoldOutcome]:
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        row = bar.add_task("grasps", total=len(grasps))

        def show(progress: HoldProgress) -> None:
            bar.update(row, completed=progress.done)

        outcomes = hold_test(grasps, None, workers=workers, options=options, progress=show)
    return [dataclasses.replace(outcome, grasp=outcome.grasp + first - 1) for outcome in outcomes]


def _table(outcomes: Sequence[HoldOutcome], options: HoldOptions) -> Table:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False, pad_edge=False)
    for heading in ("", "held", "moved mm", "turned °", "pads N", "planned N"):
        table.add_column(heading, justify="right", no_wrap=True)
    if options.first_slip:
        table.add_column("slips m/s²", justify="right")
    table.add_column("besides pads touch")
    for outcome in outcomes:
        measured, planned = (
            " ".join(f"{force:.2f}" for force in forces)
            for forces in zip(*[(pad.measured, pad.planned) for pad in outcome.pads], strict=True)
        )
        slip = [_slip(outcome)] if options.first_slip else []
        table.add_row(
            str(outcome.grasp),
            "yes" if outcome.held else "no",
            f"{1e3 * outcome.distance:.3f}",
            f"{math.degrees(outcome.angle):.2f}",
            measured,
            planned,
            *slip,
            escape(", ".join(outcome.touching)),
        )
    return table


def _slip(outcome: HoldOutcome) -> str:
    slip = outcome.first_slip
    if slip is None:
        return "-"
    return f"{slip.acceleration:.1f} {slip.direction}" if slip.slipped else f"> {slip.acceleration:.0f}"


def _lines(outcomes: Sequence[HoldOutcome], options: HoldOptions) -> list[str]:
    held = sum(outcome.held for outcome in outcomes)
    lines = [
        f"{held} of {len(outcomes)} grasps hold at rest, shaken with {options.acceleration:g} m/s² and turned with "
        f"{options.spin:g} rad/s²"
    ]
    lost = [outcome for outcome in outcomes if not outcome.held]
    lines += [f"grasp {outcome.grasp} does not: {', '.join(outcome.failed)}" for outcome in lost]
    for name in outcomes[0].controls if outcomes else ():
        holding = [str(outcome.grasp) for outcome in outcomes if outcome.controls[name]]
        said = f"holds with grasp {', '.join(holding)}: the test proves nothing" if holding else "drops every object"
        lines.append(f"control with {name}: {said}")
    return lines
