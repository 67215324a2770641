"""The command line of orders: `pinograsp rank`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import typer

import pinograsp

from . import arguments, completion
from .arguments import as_options, command
from .folders import file_name, make_folder, save
from .inputs import read_result
from .orders import ORDERS, is_measured
from .terminal import Terminal

NONE = 1
SHOWN = 10


def register(app: typer.Typer) -> None:
    """Add the command."""
    command(
        app,
        "rank",
        "pinograsp rank result.json --by clearance",
        "pinograsp rank result.json --pareto U,clearance",
        "pinograsp rank result.json --by 'joint reserve' --all --json",
        "pinograsp rank result.json --by clearance --out out",
    )(rank)


def rank(
    file: arguments.ResultFile,
    by: Annotated[
        str,
        typer.Option(
            metavar="CRITERION",
            help=f"{ORDERS}, or a figure of the certificates.",
            autocompletion=completion.criteria,
        ),
    ] = "score",
    pareto: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CRITERION,...",
            help="Only grasps that no other beats in all of these criteria.",
            autocompletion=completion.criteria,
        ),
    ] = None,
    different: Annotated[
        int, typer.Option(min=1, help="How many grasps that differ in hand pose or arm posture.")
    ] = SHOWN,
    every: Annotated[bool, typer.Option("--all", help="Every grasp, not only those that differ.")] = False,
    out: arguments.NoOut = None,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """List the grasps of a result in another order.

    The best comes first. Grasps go by their numbers in the file. Two differ if their wrists are more than 20 mm or 15
    degrees apart, or an arm joint more than 30 degrees; each stands for those that are like it.

    With --out the page of the result in this order is written as <scene>_<task>_<robot>_by_<criterion>.html: the best
    grasp, beside the best ten that differ.

    Exit codes: 0 there are grasps, 1 there are none.
    """
    terminal = Terminal(as_json, quiet)
    result = read_result(file, terminal)
    criteria = _names(pareto or ())
    if pareto and not criteria:
        raise pinograsp.InputError(
            "no criterion is named", key="--pareto", remedy=f"Known: {ORDERS.removeprefix('score, ')}"
        )
    if pareto and out is not None:
        raise pinograsp.InputError("is given with --out, whose page is of all grasps", key="--pareto")
    with as_options({"by": "--by", "criteria": "--pareto"}):
        listed = _listed(result, by, criteria, None if every else different)
    terminal.find(
        lambda: _document(result, by, criteria, listed), lambda: _report(result, by, criteria, listed, terminal)
    )
    if not listed:
        raise typer.Exit(NONE)
    if out is not None:
        make_folder(out)
        names = (result.scene, result.task, result.robot, "by", by.replace(" ", "_"))
        page = out / file_name(*names, suffix="html")
        terminal.say(save(page, lambda: pinograsp.visualization.write_html(result, page, by=by)))


def _names(texts: Sequence[str]) -> list[str]:
    """Return names that are given one after the other or with commas between them."""
    return [name.strip() for text in texts for name in text.split(",") if name.strip()]


def _listed(
    result: pinograsp.Result, by: str, criteria: list[str], most: int | None
) -> tuple[pinograsp.Different, ...]:
    """Return grasps in their order; where all are wanted, each stands for itself."""
    front = criteria or None
    if most is None:
        return tuple(pinograsp.Different(grasp, grasp.count, 1) for grasp in result.ranked(by, front))
    return result.different(most, by, front)


def _document(
    result: pinograsp.Result, by: str, criteria: list[str], listed: tuple[pinograsp.Different, ...]
) -> dict[str, object]:
    shown = [
        {"number": result.number_of(grasp), "starts": starts, "grasp_count": grasp_count, "grasp": grasp.to_json()}
        for grasp, starts, grasp_count in listed
    ]
    names = {"robot": result.robot, "scene": result.scene, "task": result.task}
    return {**names, "by": by, "pareto": criteria, "ranked": shown}


def _report(
    result: pinograsp.Result,
    by: str,
    criteria: list[str],
    listed: tuple[pinograsp.Different, ...],
    terminal: Terminal,
) -> None:
    from ..results.table import list_table

    if not listed:
        terminal.say("The result has no grasp.")
        return
    if not is_measured(by, result):
        terminal.warn(f"no grasp has {by}; the order is that of score")
    title = f"{result.task}: {len(listed)} of {len(result.grasps)} distinct grasps, {result.robot} in {result.scene}"
    title += f", by {by}" + (f", front of {', '.join(criteria)}" if criteria else "")
    terminal.table(
        list_table(result, [(grasp, starts) for grasp, starts, _ in listed], title, [by, *criteria], terminal.width)
    )
