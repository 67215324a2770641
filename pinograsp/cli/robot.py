"""The command line of robot files: `pinograsp robot new | check`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

import pinograsp

from ..disk import is_file, write_whole
from . import arguments
from .arguments import as_options, command, group, help_alone
from .folders import file_name, make_folder, save, saved
from .terminal import Terminal

SOMETHING_WRONG = 1
ZERO = (0.0, 0.0, 0.0)
NEW_OPTIONS = {
    "urdf": "URDF",
    "tip": "--tip",
    "hand": "--hand",
    "hand.urdf": "--hand",
    "hand.to": "--to",
    "hand.root": "--hand-root",
    "hand.prefix": "--prefix",
    "use_visual": "--use-visual",
    "output": "--out",
}
"""Of `robot new`, by the arguments of `new_robot_file`."""

Packages = Annotated[
    list[str] | None,
    typer.Option(
        metavar="[NAME=]FOLDER",
        help="Folder in which package:// is looked up, or NAME=FOLDER for that of one package; repeatable.",
    ),
]


def register(app: typer.Typer) -> None:
    """Add the group of commands."""
    robots = group()
    robots.callback(invoke_without_command=True)(robot)
    command(
        robots,
        "new",
        "pinograsp robot new arm.urdf --hand gripper.urdf --to tool0",
        "pinograsp robot new package://my_robots/arm.urdf --packages ~/ros/src",
    )(new)
    command(robots, "check", "pinograsp robot check robots/my_robot/robot.yaml --open")(check)
    app.add_typer(robots, name="robot")


def robot(context: typer.Context) -> None:
    """Write a first robot file for a URDF; check a robot file."""
    help_alone(context)


def check(
    robot: arguments.RobotFile,
    out: arguments.Out = Path("out"),
    packages: Packages = None,
    open_page: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Say what is wrong or doubtful with a robot file.

    Writes a page with the robot, joint sliders and pads: <robot>_check.html.

    Exit codes: 0 nothing is wrong, 1 something is.
    """
    terminal = Terminal(as_json, quiet)
    make_folder(out)
    with terminal.progress() as progress:
        report = pinograsp.check_robot(robot, progress, packages=packages or ())
        page = out / file_name(report.name, "check", suffix="html")
        written = saved(_files(report, page))
    terminal.find(report.to_json, lambda: _report(report, terminal))
    for line in written:
        terminal.say(line)
    if written and open_page:
        typer.launch(str(page))
    if report.wrong:
        raise typer.Exit(SOMETHING_WRONG)


def new(
    urdf: Annotated[
        str,
        typer.Argument(metavar="URDF", help="URDF of the robot or the arm: path, or package:// address in a wheel."),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Folder of the robot file, robot.yaml; its name is that of the robot.",
            show_default="robots/<name of the URDF>",
        ),
    ] = None,
    hand: Annotated[str | None, typer.Option(help="URDF of a hand that the robot's URDF does not hold.")] = None,
    to: Annotated[
        str | None, typer.Option(help="Link that the hand sits on.", show_default="the arm's last one")
    ] = None,
    xyz: Annotated[tuple[float, float, float], typer.Option(metavar="X Y Z", help="Where on the link, m.")] = ZERO,
    rpy: Annotated[
        tuple[float, float, float],
        typer.Option(metavar="ROLL PITCH YAW", help="How it is turned on the link, rad."),
    ] = ZERO,
    prefix: Annotated[str, typer.Option(help="Put before the names of the hand's links and joints.")] = "",
    hand_root: Annotated[str | None, typer.Option(help="Link of the hand's URDF with which the hand begins.")] = None,
    tip: Annotated[str | None, typer.Option(help="Link that carries the fingers, where arms branch.")] = None,
    packages: Packages = None,
    use_visual: Annotated[
        bool, typer.Option("--use-visual", help="Links without collision geometry collide as they are shown.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace a robot file that is there.")] = False,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Write a first robot file for a URDF.

    It has arm, hand, limits, and as pads the flat faces of the fingers that close on each other. What a URDF does not
    say is marked with CHECK in the file.

    Exit codes: 0 the file is whole but for these marks, 1 its pads have to be written by hand.
    """
    terminal = Terminal(as_json, quiet)
    name = Path(urdf).stem.lstrip(".") or "robot"  # ".." would lead out of the folder
    file = (Path("robots") / name if out is None else out) / "robot.yaml"
    mount = None
    if hand is not None:
        mount = pinograsp.HandMount(hand, to=to, root=hand_root, position=xyz, rpy=rpy, prefix=prefix)
    elif to is not None or hand_root is not None:
        key = "--hand-root" if to is None else "--to"
        raise pinograsp.InputError("is for a hand with a URDF of its own", key=key, remedy="Give that with --hand")
    if is_file(file) and not force:
        raise pinograsp.InputError("exists already", file=file, key="--out", remedy="Use --force to replace it")
    with as_options(NEW_OPTIONS), terminal.progress() as progress:
        draft = pinograsp.new_robot_file(
            urdf, file, hand=mount, tip=tip, packages=packages or (), use_visual=use_visual, progress=progress
        )
    written = save(file, lambda: write_whole(file, draft.text))
    terminal.find(lambda: {"file": str(file), **draft.to_json()}, lambda: _new_report(file, draft, terminal))
    terminal.say(written)
    if not draft.pads:
        raise typer.Exit(SOMETHING_WRONG)
    terminal.say(f"next: pinograsp robot check {file}")


def _report(report: pinograsp.RobotReport, terminal: Terminal) -> None:
    from ..onboarding.table import findings_table, links_table, summary

    terminal.table(findings_table(report))
    if report.links:
        terminal.say("")
        terminal.table(links_table(report))
    terminal.say(summary(report))


def _files(report: pinograsp.RobotReport, page: Path) -> Iterator[str]:
    """Write the page of a robot that can be drawn, and yield what to say of it."""
    if (robot := report.robot) is not None:
        yield save(page, lambda: pinograsp.visualization.write_robot_html(robot, page, report.findings, report.faces))


def _new_report(file: Path, draft: pinograsp.Draft, terminal: Terminal) -> None:
    for line in draft.summary():
        terminal.say(line)
    for number, line in draft.checks.items():
        terminal.say(f"{typer.style(f'{file}:{number}', fg='yellow')}: {line}")
