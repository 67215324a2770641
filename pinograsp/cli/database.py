"""The command line of start databases: `pinograsp database build | info | query | coverage | export`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

import pinograsp

from ..interrupts import exit_code
from ..progress import Progress
from . import arguments
from .arguments import as_options, command, given, group, help_alone
from .database_query import NOTHING_FOUND, File, query
from .folders import file_name, make_folder, save, saved
from .inputs import read_robot
from .terminal import Terminal, fail

if TYPE_CHECKING:
    from ..database.coverage import Coverage


def register(app: typer.Typer) -> None:
    """Add the group of commands."""
    databases = group()
    databases.callback(invoke_without_command=True)(database)
    command(databases, "build", "pinograsp database build glovebox.duckdb --scene glovebox --size 1e6")(build)
    command(databases, "info", "pinograsp database info glovebox.duckdb")(info)
    command(
        databases,
        "query",
        "pinograsp database query glovebox.duckdb --center 0.8 0.0 -0.1",
        "pinograsp database query glovebox.duckdb --center 0.8 0 -0.1 --cone 0 0 -1",
    )(query)
    command(databases, "coverage", "pinograsp database coverage glovebox.duckdb --html --out out")(coverage)
    command(databases, "export", "pinograsp database export glovebox.duckdb starts.parquet")(export)
    app.add_typer(databases, name="database")


def database(context: typer.Context) -> None:
    """Build and query databases of arm configurations."""
    help_alone(context)


def build(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Database; one that is there is resumed or grown.")],
    scene: Annotated[
        str,
        typer.Option(
            help="Scene file, or name of a shipped scene; its enclosure and obstacles count.",
            autocompletion=arguments.completion.scenes,
        ),
    ],
    size: Annotated[float, typer.Option(help="Configurations wanted, for example 21e6.")],
    robot: arguments.Robot = arguments.DEFAULT_ROBOT,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the samples.")] = 0,
    spread: Annotated[
        Literal["joints", "wrist"], typer.Option(help="Uniform joint angles, or even wrist positions.")
    ] = "joints",
    margin: Annotated[
        float | None,
        typer.Option(min=0.0, help="Least distance to walls, obstacles and itself, m.", show_default="0.005"),
    ] = None,
    robot_margin: Annotated[
        float | None, typer.Option(min=0.0, help="Least distance to itself, m.", show_default="that of --margin")
    ] = None,
    wait: Annotated[bool, typer.Option("--wait", help="Wait while another process builds this database.")] = False,
    workers: arguments.Workers = None,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Build a database, or resume or grow one.

    Ctrl-C keeps what is done.

    Exit codes: 0 it is built, 1 no configuration is free of collision, 130 and 143 interrupted.
    """
    terminal = Terminal(as_json, quiet)
    if not 1 <= size <= 1e10:
        raise pinograsp.InputError("must be between 1 and 1e10", key="--size")
    described = pinograsp.load_scene(scene)
    distances = given(enclosure=margin, robot=margin if robot_margin is None else robot_margin)
    with as_options({"enclosure": "--margin", "robot": "--robot-margin"}):
        margins = pinograsp.Margins(**distances)
    try:
        with terminal.progress() as progress, as_options({"workers": "--workers"}):
            model = read_robot(robot)
            built = pinograsp.build_database(
                model,
                described,
                file,
                size=int(size),
                seed=seed,
                margins=margins,
                spread=spread,
                workers=workers,
                wait=wait,
                progress=progress,
            )
            with built:
                facts = built.info()
    except KeyboardInterrupt:
        fail(f"interrupted; the same command goes on where {file} ends")
        raise typer.Exit(exit_code()) from None
    terminal.find(lambda: facts, lambda: terminal.say(f"{facts['rows']:,} configurations in {file}"))
    if not facts["rows"]:
        drawn = facts["samples_drawn"]
        terminal.warn(
            f"none of {drawn:,} random configurations is free of collision: check mounting, enclosure and margins"
        )
        raise typer.Exit(NOTHING_FOUND)


def info(file: File, as_json: arguments.Json = False, quiet: arguments.Quiet = False) -> None:
    """Print counts, layout and origin of a database."""
    terminal = Terminal(as_json, quiet)
    with pinograsp.Database.open(file) as opened:
        facts = opened.info()
    terminal.find(lambda: facts, lambda: _say(facts, terminal))


def coverage(
    file: File,
    voxel: Annotated[float | None, typer.Option(min=0.005, help="Edge of a voxel, m.", show_default="0.05")] = None,
    png: Annotated[bool, typer.Option("--png", help="Write a picture of slices.")] = False,
    html: Annotated[bool, typer.Option("--html", help="Write a page with the voxels.")] = False,
    out: arguments.Out = Path("out"),
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Say which parts of the enclosure the wrist reaches.

    It also says from how many directions. Picture and page are <database>_coverage.png and .html.
    """
    terminal = Terminal(as_json, quiet)
    if png or html:
        make_folder(out)
    with terminal.progress() as progress, pinograsp.Database.open(file) as opened:
        progress(Progress("counting voxels", 0))
        found = pinograsp.Coverage.of(opened, **given(voxel=voxel))
        title = f"{found.rows:,} configurations in {file.name}"
        written = saved(_pictures(found, title, file.stem, out, png, html))
    from ..frozen import json_data  # with NumPy, which help does not need

    shown = ("rows", "voxel", "origin", "voxels", "reached", "mean_directions")
    document = {name: json_data(getattr(found, name)) for name in shown}
    line = (
        f"{title}: the wrist reaches {100 * found.reached:.0f} % of the {found.voxels} voxels of "
        f"{1e3 * found.voxel:.0f} mm, a reached one from {found.mean_directions:.1f} of 24 directions on average "
        "(a larger database may find more)"
    )
    terminal.find(lambda: document, lambda: terminal.say(line))
    for said in written:
        terminal.say(said)


def _pictures(found: Coverage, title: str, stem: str, folder: Path, png: bool, html: bool) -> Iterator[str]:
    """Write the files that are asked for, and yield what to say of each."""
    if png:
        picture = folder / file_name(stem, "coverage", suffix="png")
        yield save(picture, lambda: pinograsp.visualization.coverage_png(found, picture, title))
    if html:
        page = folder / file_name(stem, "coverage", suffix="html")
        yield save(page, lambda: pinograsp.visualization.coverage_html(found, page, title))


def export(
    file: File,
    parquet: Annotated[Path, typer.Argument(metavar="PARQUET", help="Parquet file to write.")],
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Write all configurations as one Parquet file.

    Angles are in rad (m), under the names of their joints.
    """
    terminal = Terminal(as_json, quiet)
    with terminal.progress() as progress, pinograsp.Database.open(file) as opened:
        rows = opened.rows()
        progress(Progress("writing configurations", 0, rows))
        written = save(parquet, lambda: opened.export_parquet(parquet))
    terminal.find(lambda: {"file": str(parquet), "rows": rows}, lambda: terminal.say(f"{rows:,} configurations"))
    terminal.say(written)


def _say(facts: dict[str, Any], terminal: Terminal, before: str = "") -> None:
    """Print facts one a line, those of a part of it below its name."""
    for name, fact in facts.items():
        if isinstance(fact, dict):
            terminal.say(f"{before}{name}:")
            _say(fact, terminal, before + "  ")
        else:
            text = (
                ", ".join(map(str, fact)) if isinstance(fact, list) else f"{fact:,}" if isinstance(fact, int) else fact
            )
            terminal.say(f"{before}{name}: {text}")
