"""The command line of plans: `pinograsp plan`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.markup import escape

from ..descriptions import load_robot_description, load_scene
from ..kinematics.robot import Robot
from ..planning.defaults import DEFAULT_STARTS
from ..planning.one_shot import plan
from ..results import Result, write_json
from ..results.criteria import ALIASES, BY_NAME, criterion_of, numbers_of
from ..results.ranking import SCORE
from ..results.table import grasp_table, outcome_lines
from ..solve.backends import BACKENDS
from ..solve.options import SolverOptions
from .console import say
from .folders import make_folder
from .progress_bar import ProgressBar

NOTHING_FOUND, INTERRUPTED = 1, 130
ORDERS = (SCORE, *BY_NAME, *ALIASES)
SOLVERS_HELP = f"Solver: {', '.join(BACKENDS)}."
ORDERS_HELP = f"Order of table and page, not of the JSON file: {', '.join(ORDERS)}."


def _one_of(names: Iterable[str]) -> Callable[[str], str]:
    """Return a callback that passes these names and refuses any other as a wrong use of the command."""

    def known(name: str) -> str:
        if name not in names:
            raise typer.BadParameter(f"{name!r} is not one of {', '.join(names)}.")
        return name

    return known


def plan_command(
    scene: Annotated[str, typer.Argument(help="Scene file, or the name of a shipped scene.")],
    task: Annotated[str, typer.Option(help="Name of a task of the scene.")],
    robot: Annotated[str, typer.Option(help="Robot file or folder, or the name of a shipped robot.")] = "gen3_2f85",
    starts: Annotated[int, typer.Option(min=1, help="Number of starts.")] = DEFAULT_STARTS,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; by default one for each core.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the starts.")] = 0,
    database: Annotated[Path | None, typer.Option(help="Start database; by default a small one, cached.")] = None,
    algorithm: Annotated[str, typer.Option(help=SOLVERS_HELP, callback=_one_of(BACKENDS))] = "LD_SLSQP",
    max_evaluations: Annotated[int | None, typer.Option(min=1, help="Budget of evaluations a start.")] = None,
    out: Annotated[Path, typer.Option(help="Folder of the JSON and HTML files.")] = Path("out"),
    rank_by: Annotated[str, typer.Option(help=ORDERS_HELP, callback=_one_of(ORDERS))] = SCORE,
    html: Annotated[bool, typer.Option(help="Write the page with the best grasp.")] = True,
) -> None:
    """Find, verify and rank grasps; write them as JSON and the best one as an HTML page."""
    console = Console()
    robot_model, description = Robot(load_robot_description(robot)), load_scene(scene)
    options = SolverOptions(algorithm=algorithm, max_evaluations=max_evaluations)
    make_folder(out)  # before the work, not after it
    with ProgressBar(console) as bar:
        result = plan(
            robot_model,
            description,
            task,
            starts=starts,
            workers=workers,
            seed=seed,
            options=options,
            database=database,
            progress=bar,
            build_progress=bar,
        )
    _report(result, console, rank_by)
    written = out / f"{description.name}_{task}.json"
    write_json(result, written)
    say(console, f"written: {escape(str(written))}")
    if html and result.best:
        from ..visualization import write_html

        page = written.with_suffix(".html")
        write_html(result, page, caption=outcome_lines(result)[0], by=rank_by)
        say(console, f"written: {escape(str(page))}")
    if result.interrupted:
        raise typer.Exit(INTERRUPTED)
    if not result.grasps:
        raise typer.Exit(NOTHING_FOUND)


def _is_measured(rank_by: str, result: Result) -> bool:
    """Return whether a grasp has what they are to be ordered by."""
    if rank_by == SCORE:
        return True
    values = criterion_of(rank_by, result.grasps).values([numbers_of(grasp) for grasp in result.grasps])
    return not np.isnan(values).all()


def _report(result: Result, console: Console, rank_by: str) -> None:
    for warning in result.warnings:
        say(console, f"[yellow]warning:[/] {escape(warning)}")
    if result.grasps:
        if not _is_measured(rank_by, result):
            say(console, f"[yellow]warning:[/] no grasp has {rank_by}; the order is that of {SCORE}")
        console.print(grasp_table(result, by=rank_by))
    else:
        say(console, "[bold]No verified grasp was found.[/]")
    for line in outcome_lines(result):
        say(console, escape(line))
    text = f"{result.times['total']:.1f} s in all"
    if result.done:
        solver, check = 1e3 * result.times["solver_mean"], 1e3 * result.times["verification_mean"]
        text += f"; a start takes {solver:.1f} ms in the solver and {check:.1f} ms in the check, on one core"
    say(console, text)
