"""The command line of plans: `pinograsp plan`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

import pinograsp

from ..interrupts import exit_code, held
from ..planning.defaults import DEFAULT_STARTS
from . import arguments, completion
from .arguments import as_options, command, given
from .folders import file_name, make_folder, remove, save, saved
from .inputs import read_robot, read_scene, scene_words
from .orders import ORDERS, is_measured, require_order
from .terminal import Terminal

NOTHING_FOUND = 1


def register(app: typer.Typer) -> None:
    """Add the command."""
    command(
        app,
        "plan",
        "pinograsp plan glovebox --task sphere",
        "pinograsp plan my_scene.yaml --task can --robot my_robot --lock elbow=0",
        "pinograsp plan glovebox --task sphere --most 3 --deadline 10",
    )(plan)


def plan(
    scene: arguments.Scene,
    task: arguments.Task,
    robot: arguments.Robot = arguments.DEFAULT_ROBOT,
    starts: Annotated[
        int | None, typer.Option(min=1, help="Number of starts.", show_default=str(DEFAULT_STARTS))
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of the choice of starts.", show_default="0")] = None,
    workers: arguments.Workers = None,
    most: Annotated[
        int | None, typer.Option(min=1, help="Only the first grasps, so many.", show_default="no such end")
    ] = None,
    deadline: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            metavar="SECONDS",
            help="Only the first grasps, of starts begun within so many seconds.",
            show_default="no such end",
        ),
    ] = None,
    lock: arguments.Locks = None,
    object_pose: arguments.ObjectPose = None,
    rank_by: Annotated[
        str,
        typer.Option(
            help=f"Order of table and page, not of the JSON file: {ORDERS}.",
            autocompletion=completion.criteria,
        ),
    ] = "score",
    database: Annotated[
        Path | None, typer.Option(help="Start database.", show_default="a small one, built once in the cache folder")
    ] = None,
    algorithm: Annotated[
        str | None, typer.Option(help="Solver: LD_SLSQP, or LN_COBYLA as in the paper.", show_default="LD_SLSQP")
    ] = None,
    max_evaluations: Annotated[
        int | None, typer.Option(min=1, help="Budget of evaluations of a solve.", show_default="that of the solver")
    ] = None,
    tries: Annotated[int | None, typer.Option(min=1, help="Solves of a start at most.", show_default="3")] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(help="Scaled violation that counts as feasible; 1e-4 is a micrometre.", show_default="1e-4"),
    ] = None,
    cost_tolerance: Annotated[
        float | None, typer.Option(help="Change of the scaled cost at which a solve stops.", show_default="1e-6")
    ] = None,
    projection: Annotated[
        str | None,
        typer.Option(
            help="Conditions that a start is projected on: nothing, contacts, or contacts and clearance.",
            show_default="contacts and clearance",
        ),
    ] = None,
    out: arguments.Out = Path("out"),
    html: Annotated[bool, typer.Option(help="Write the page with the best grasp.")] = True,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Find, verify and rank grasps.

    With --most or --deadline only the first few: this process tries the starts whose hand is nearest to the object, one
    after the other and briefly, and ends as well where no grasp can be better. Models and the start database count
    among the seconds of the deadline.

    They are written as JSON and the best one as a page: <scene>_<task>_<robot>.json and .html. Where none was found the
    page shows the posture that came nearest to one. Ctrl-C and SIGTERM end the search and write what was found until
    then. Where no page is written, that of an earlier plan is removed. With --json the document is that of the JSON
    file.

    Exit codes: 0 grasps were found, 1 none was found, 130 and 143 interrupted.
    """
    terminal = Terminal(as_json, quiet)
    described = read_scene(scene, task, object_pose, lock)
    quick, whole = given(most=most, deadline=deadline), given(starts=starts, seed=seed)
    _require_one_kind(quick, whole)
    solver = given(
        algorithm=algorithm,
        max_evaluations=max_evaluations,
        tries=tries,
        tolerance=tolerance,
        cost_tolerance=cost_tolerance,
        projection=projection,
    )
    with as_options({"by": "--rank-by", **{name: f"--{name.replace('_', '-')}" for name in solver}}):
        require_order(rank_by)
        options = pinograsp.SolverOptions(**solver)
    from ..results.encoding import encode

    make_folder(out)
    names = {name: f"--{name}" for name in ("starts", "workers", "deadline")}
    with terminal.progress() as progress, as_options(names), scene_words(scene, described, task, object_pose, lock):
        model = read_robot(robot)
        session: dict[str, Any] = {"workers": workers, "options": options, "database": database, "progress": progress}
        with held():
            with pinograsp.Planner(model, described, **session) as planner:
                result = planner.first(task, **quick) if quick else planner.plan(task, **whole)
            if result.interrupted and not result.done:  # what an earlier plan found is worth more
                raise KeyboardInterrupt
            written = saved(_files(result, out, rank_by, html))
    terminal.find(lambda: encode(result), lambda: _report(result, terminal, rank_by))
    for line in written:
        terminal.say(line)
    _exit(result)


def _require_one_kind(quick: dict[str, Any], whole: dict[str, Any]) -> None:
    """Refuse options of the first few grasps beside those of a whole plan."""
    if quick and whole:
        of, other = next(iter(whole)), next(iter(quick))
        raise pinograsp.InputError(f"is given with --{other}", key=f"--{of}", remedy="Give one of them")


def _exit(result: pinograsp.Result) -> None:
    """End with the exit code of a result without grasps, or of one that was interrupted."""
    if result.interrupted:
        raise typer.Exit(exit_code())
    if not result.grasps:
        raise typer.Exit(NOTHING_FOUND)


def _files(result: pinograsp.Result, folder: Path, rank_by: str, html: bool) -> Iterator[str]:
    """Write the files, and yield what to say of each."""
    from ..results.table import outcome_lines

    file = folder / file_name(result.scene, result.task, result.robot, suffix="json")
    yield save(file, lambda: pinograsp.write_json(result, file))
    page, caption = file.with_suffix(".html"), outcome_lines(result)[0]
    missed = None if result.explanation is None else result.explanation.nearest_miss
    if not html or (result.best is None and missed is None):  # one that is there shows a file that is no more
        yield from remove(page)
    else:
        yield save(page, lambda: pinograsp.visualization.write_html(result, page, caption=caption, by=rank_by))


def _report(result: pinograsp.Result, terminal: Terminal, rank_by: str) -> None:
    from ..results.table import grasp_table, outcome_lines

    for warning in result.warnings:
        terminal.warn(warning)
    if result.grasps:
        if not is_measured(rank_by, result):
            terminal.warn(f"no grasp has {rank_by}; the order is that of score")
        terminal.table(grasp_table(result, by=rank_by, width=terminal.width))
    else:
        terminal.say(typer.style("No verified grasp was found.", bold=True))
    for line in outcome_lines(result):
        terminal.say(line)
    if not result.grasps and not result.interrupted:
        terminal.say("what would help: pinograsp why, with the same scene, task and robot")
    text = f"{result.times['total']:.1f} s in all"
    if result.done:
        solver, check = 1e3 * result.times["solver_mean"], 1e3 * result.times["verification_mean"]
        text += f"; a start takes {solver:.1f} ms in the solver and {check:.1f} ms in the check, on one core"
    terminal.say(text)
