"""The command line of robot files: `pinograsp robot new | check`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from ..descriptions.pose import ZERO
from ..errors import InputError
from ..onboarding.check import RobotReport, check_robot
from ..onboarding.new import HandMount, new_robot_file, refuse_existing, summary_lines, write_new
from ..onboarding.table import findings_table, links_table, summary
from .folders import make_folder

app = typer.Typer(no_args_is_help=True, help="Write a first robot file for a URDF; check a robot file.")
SOMETHING_WRONG = 1


@app.command("check")
def check(
    robot: Annotated[str, typer.Argument(help="Robot file or folder, or the name of a shipped robot.")],
    out: Annotated[Path, typer.Option(help="Folder of the HTML page.")] = Path("out"),
    open_page: Annotated[bool, typer.Option("--open/--no-open", help="Open the page in the browser.")] = False,
) -> None:
    """Say what is wrong or doubtful with a robot file, and write a page with the robot, joint sliders and pads.

    Exits with 1 if something is wrong.
    """
    console = Console()
    with console.status("looking at the robot"):
        report = check_robot(robot)
    console.print(findings_table(report))
    if report.links:
        console.print(links_table(report))
    console.print(summary(report), highlight=False)
    page = _write_page(report, out)
    if page is not None:
        console.print(f"written: {escape(str(page))}", highlight=False, soft_wrap=True)
        if open_page:
            typer.launch(str(page))
    if report.wrong:
        raise typer.Exit(SOMETHING_WRONG)


@app.command("new")
def new(
    urdf: Annotated[str, typer.Argument(help="URDF of the robot or the arm: path, or package:// address in a wheel.")],
    output: Annotated[
        Path | None, typer.Option(help="Robot file to write; by default robots/<name of the URDF>/robot.yaml.")
    ] = None,
    hand: Annotated[str | None, typer.Option(help="URDF of a hand that the robot's URDF does not hold.")] = None,
    to: Annotated[str | None, typer.Option(help="Link that the hand sits on; by default the arm's last one.")] = None,
    xyz: Annotated[tuple[float, float, float], typer.Option(help="Where on the link, m.")] = ZERO,
    rpy: Annotated[tuple[float, float, float], typer.Option(help="Roll, pitch, yaw on the link, rad.")] = ZERO,
    prefix: Annotated[str, typer.Option(help="Put before the names of the hand's links and joints.")] = "",
    hand_root: Annotated[str | None, typer.Option(help="Link of the hand's URDF with which the hand begins.")] = None,
    tip: Annotated[str | None, typer.Option(help="Link that carries the fingers, where arms branch.")] = None,
    packages: Annotated[list[Path] | None, typer.Option(help="Folder in which package:// is looked up.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a robot file that is there.")] = False,
) -> None:
    """Write a first robot file: arm, hand, limits, and flat faces of the fingers that close on each other as pads.

    What a URDF does not say is marked with CHECK. Exits with 1 if the pads have to be written by hand.
    """
    console = Console()
    file = Path("robots") / Path(urdf).stem / "robot.yaml" if output is None else output
    mount = None
    if hand is not None:
        mount = HandMount(hand, to=to, root=hand_root, position=xyz, rpy=rpy, prefix=prefix)
    elif to is not None or hand_root is not None:
        key = "--hand-root" if to is None else "--to"
        raise InputError("is for a hand with a URDF of its own", key=key, remedy="Give that with --hand")
    refuse_existing(file, replace=force)
    with console.status("looking at the URDF"):
        text, found = new_robot_file(urdf, file, hand=mount, tip=tip, packages=packages or ())
    write_new(text, file)
    for line in (*summary_lines(found), f"written: {file}"):
        console.print(escape(line), highlight=False, soft_wrap=True)
    for number, line in enumerate(text.splitlines(), 1):
        if "CHECK" in line and number > 1:
            where = escape(f"{file}:{number}")
            console.print(f"[yellow]{where}[/]: {escape(line.strip())}", highlight=False, soft_wrap=True)
    if found.pads is None:
        raise typer.Exit(SOMETHING_WRONG)
    console.print(f"next: pinograsp robot check {escape(str(file))}", highlight=False, soft_wrap=True)


def _write_page(report: RobotReport, folder: Path) -> Path | None:
    """Write the page of a check, and return where; None if there is no robot to show."""
    if report.robot is None:
        return None
    from ..visualization.robot_page import Remark, write_robot_html

    make_folder(folder)
    page = folder / f"{report.robot.description.name}_check.html"
    remarks = [Remark(finding.level, finding.what, finding.remedy) for finding in report.findings]
    write_robot_html(report.robot, remarks, page)
    return page
