"""The command line of start databases: `pinograsp database build | info | query | coverage | export`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from ..database.build import build_database
from ..database.coverage import Coverage
from ..database.query import Configurations, configurations_near, spread_configurations
from ..database.spread import Spread
from ..database.store import Database
from ..descriptions import load_robot_description, load_scene
from ..descriptions.scene import Margins
from ..errors import InputError
from ..geometry.cone import Cone
from ..kinematics.robot import Robot
from .progress_bar import ProgressBar

app = typer.Typer(no_args_is_help=True, help="Build, inspect and query databases of collision-free configurations.")
File = Annotated[Path, typer.Argument(help="Database file.")]


@app.command("build")
def build(
    out: Annotated[Path, typer.Option(help="Database file; resumed or grown if it exists.")],
    scene: Annotated[str, typer.Option(help="Scene file or name; its enclosure and obstacles count.")],
    size: Annotated[float, typer.Option(help="Configurations wanted, for example 21e6.")],
    robot: Annotated[str, typer.Option(help="Robot file or name.")] = "gen3_2f85",
    seed: Annotated[int, typer.Option(min=0, help="Seed of the samples.")] = 0,
    spread: Annotated[Spread, typer.Option(help="Uniform joints, or even wrist positions.")] = "joints",
    margin: Annotated[float, typer.Option(min=0.0, help="Least distance to enclosure and itself, m.")] = 0.005,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; by default one for each core.")] = None,
) -> None:
    """Build a database, or resume or grow the one that is there; Ctrl-C keeps what is done."""
    if not 1 <= size <= 1e10:
        raise InputError("must be between 1 and 1e10", key="--size")
    model, description = Robot(load_robot_description(robot)), load_scene(scene)
    console = Console()
    try:
        with ProgressBar(console) as bar:
            database = build_database(
                model,
                description,
                out,
                size=int(size),
                seed=seed,
                margins=Margins(enclosure=margin, robot=margin),
                spread=spread,
                workers=workers,
                progress=bar,
            )
    except KeyboardInterrupt:
        console.print(f"interrupted; the same command goes on where {out} ends", highlight=False)
        raise typer.Exit(130) from None
    with database:
        facts = database.info()
    console.print(f"{facts['rows']:,} configurations in {out}", highlight=False)
    if not facts["rows"]:
        console.print(
            f"None of {facts['samples drawn']:,} random configurations is free of collision: check mounting, "
            "enclosure and margins of the scene.",
            highlight=False,
        )
        raise typer.Exit(1)


@app.command("info")
def info(file: File) -> None:
    """Print counts, layout, metadata and hashes as JSON."""
    with Database.open(file) as database:
        typer.echo(json.dumps(database.info(), indent=2))


@app.command("query")
def query(
    file: File,
    center: Annotated[tuple[float, float, float], typer.Option(help="Point in the world, m.")],
    radius: Annotated[float, typer.Option(min=0.0, help="Radius of the ball around it, m.")] = 0.1,
    cone: Annotated[tuple[float, float, float] | None, typer.Option(help="Axis of approach directions.")] = None,
    angle: Annotated[float, typer.Option(help="Half-angle of the cone, degrees.")] = 30.0,
    count: Annotated[int, typer.Option(min=1, help="Rows to print.")] = 10,
    spread: Annotated[bool, typer.Option(help="Spread the rows over position, approach and posture.")] = True,
) -> None:
    """Print configurations whose wrist is near a point."""
    directions = None if cone is None else Cone(np.array(cone), float(np.radians(angle)))
    with Database.open(file) as database:
        if spread:
            found = spread_configurations(database, np.array(center), radius, count, cone=directions)
        else:
            found = configurations_near(database, np.array(center), radius, cone=directions, limit=count)
        names = database.joints()
    Console().print(_table(found, names))


def _table(found: Configurations, names: list[str]) -> Table:
    table = Table(title=f"{len(found)} configurations; joints in rad, positions in m, clearance in mm")
    for name in (*names, "wrist", "approach", "clear"):
        table.add_column(name, justify="right")
    for q, position, approach, clearance in zip(
        found.q, found.positions, found.approaches, found.clearances, strict=True
    ):
        table.add_row(
            *(f"{angle:.3f}" for angle in q),
            " ".join(f"{value:.3f}" for value in position),
            " ".join(f"{value:.2f}" for value in approach),
            f"{1e3 * clearance:.0f}",
        )
    return table


@app.command("export")
def export(file: File, out: Annotated[Path, typer.Option(help="Parquet file.")]) -> None:
    """Write all configurations as one Parquet file, angles under the names of their joints."""
    with Database.open(file) as database:
        database.export_parquet(out)
    typer.echo(f"written: {out}")


@app.command("coverage")
def coverage(
    file: File,
    voxel: Annotated[float, typer.Option(min=0.005, help="Edge of a voxel, m.")] = 0.05,
    png: Annotated[Path | None, typer.Option(help="Picture of slices.")] = None,
    html: Annotated[Path | None, typer.Option(help="Page with the voxels in meshcat.")] = None,
) -> None:
    """Say which parts of the box the wrist reaches, from how many directions; draw it if asked."""
    with Database.open(file) as database:
        found = Coverage.of(database, voxel)
        title = f"{database.rows():,} configurations in {file.name}"
    often = found.directions[found.counts > 0]
    typer.echo(
        f"{title}: the wrist reaches {100 * found.reached:.0f} % of the {found.counts.size} voxels of "
        f"{1e3 * voxel:.0f} mm, a reached one from {often.mean():.1f} of 24 directions on average "
        "(a larger database may find more)"
    )
    if png is not None:
        from ..visualization import coverage_png

        coverage_png(found, png, title)
        typer.echo(f"written: {png}")
    if html is not None:
        from ..visualization import coverage_html

        coverage_html(found, html, title)
        typer.echo(f"written: {html}")
