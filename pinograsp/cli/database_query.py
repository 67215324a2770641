"""The command line of questions to start databases: `pinograsp database query`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import pinograsp

from ..tables import GAP, Table
from . import arguments
from .arguments import as_options
from .terminal import Terminal

if TYPE_CHECKING:
    from ..database.query import Configurations

NOTHING_FOUND = 1
DEFAULT_RADIUS = 0.1
File = Annotated[Path, typer.Argument(metavar="FILE", help="Database.")]


def query(
    file: File,
    center: Annotated[tuple[float, float, float], typer.Option(metavar="X Y Z", help="Point in the world, m.")],
    radius: Annotated[
        float | None, typer.Option(min=0.0, help="Radius of the ball around it, m.", show_default="0.1")
    ] = None,
    box: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="X Y Z", help="Half edges of a box around it, m.", show_default="a ball"),
    ] = None,
    cone: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="X Y Z", help="Axis of the approach directions, in the world.", show_default="any"),
    ] = None,
    angle: Annotated[float, typer.Option(help="Half-angle of the cone, degrees.")] = 30.0,
    joint: Annotated[
        list[str] | None,
        typer.Option(
            metavar="JOINT=LEAST,MOST",
            help="Interval of an arm joint, rad (m); can be repeated, several of one joint are alternatives.",
        ),
    ] = None,
    count: Annotated[int, typer.Option(min=1, help="Rows to print.")] = 10,
    spread: Annotated[bool, typer.Option(help="Spread the rows over position, approach and posture.")] = True,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the choice of rows that are spread.")] = 0,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Print configurations whose wrist is near a point.

    They are in a ball or a box around it.

    Exit codes: 0 there are some, 1 there are none.
    """
    import numpy as np

    terminal = Terminal(as_json, quiet)
    if box is not None and radius is not None:
        raise pinograsp.InputError("is given with --radius", key="--box", remedy="Give one of them")
    extent = np.array(box) if box is not None else DEFAULT_RADIUS if radius is None else radius
    intervals, directions = read_intervals(joint or ()), None
    if cone is not None:
        with as_options({"axis": "--cone", "half_angle": f"--angle {angle:g}°"}):
            directions = pinograsp.DirectionCone(np.array(cone), math.radians(angle))
    sizes = {"center": "--center", "extent": "--radius" if box is None else "--box", "joints": "--joint"}
    with pinograsp.Database.open(file) as opened, as_options({**sizes, "count": "--count", "limit": "--count"}):
        middle = np.array(center)
        if spread:
            found = pinograsp.spread_configurations(
                opened, middle, extent, count, cone=directions, joints=intervals, seed=seed
            )
        else:
            found = pinograsp.configurations_near(
                opened, middle, extent, cone=directions, joints=intervals, limit=count
            )
    terminal.find(found.to_json, lambda: terminal.table(configurations_table(found, terminal.width)))
    if not len(found):
        raise typer.Exit(NOTHING_FOUND)


def read_intervals(texts: Sequence[str]) -> dict[str, list[tuple[float, float]]]:
    """Return the intervals of texts such as `elbow=-0.5,0.5`, by joint.

    Raises:
        InputError: a text is not of this kind, or its ends are no numbers.
    """
    found: dict[str, list[tuple[float, float]]] = {}
    for text in texts:
        name, _, ends = text.rpartition("=")
        try:
            least, most = map(float, ends.split(","))
        except ValueError:
            least, most = math.nan, math.nan
        if not (name and math.isfinite(least) and math.isfinite(most)):
            remedy = "Give, for example, elbow=-0.5,0.5"
            raise pinograsp.InputError(f"{text!r} is not JOINT=LEAST,MOST", key="--joint", remedy=remedy)
        found.setdefault(name, []).append((least, most))
    return found


def configurations_table(found: Configurations, width: int) -> Table:
    """Return a table of configurations; angles for which a line has no room follow in the next one."""
    from ..results.table import angle_lines

    table = Table(f"{len(found)} configurations; arm joints {', '.join(found.joints)}")
    table.numbers("wrist\nmm", "approach\n", "clear\nmm")
    table.lines(" arm joints\n °")
    taken = 17 + 17 + 5 + 3 * GAP
    rows = zip(found.q, found.positions, found.approaches, found.clearances, strict=True)
    for q, position, approach, clearance in rows:
        table.add(
            "".join(f"{1e3 * x:6.0f}" for x in position)[1:],
            "".join(f"{x:6.2f}" for x in approach)[1:],
            f"{1e3 * clearance:.0f}",
            angle_lines(q, width - taken),
        )
    return table
