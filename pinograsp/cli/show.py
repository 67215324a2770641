"""The command line of single grasps: `pinograsp show`."""

from __future__ import annotations

from typing import Annotated

import typer

import pinograsp

from . import arguments
from .arguments import command
from .folders import file_name, make_folder, save
from .inputs import grasp_of, read_result
from .terminal import Terminal


def register(app: typer.Typer) -> None:
    """Add the command."""
    command(
        app,
        "show",
        "pinograsp show result.json",
        "pinograsp show result.json --grasp 3 --out out --open",
    )(show)


def show(
    file: arguments.ResultFile,
    grasp: arguments.GraspNumber = 1,
    out: arguments.NoOut = None,
    open_page: Annotated[bool, typer.Option("--open", help="Open the page in the browser; needs --out.")] = False,
    as_json: arguments.Json = False,
    quiet: arguments.Quiet = False,
) -> None:
    """Show a grasp of a result: joints, contacts, certificate.

    With --out its page is written as <scene>_<task>_<robot>_grasp<number>.html.
    """
    terminal = Terminal(as_json, quiet)
    result = read_result(file, terminal)
    chosen = grasp_of(result, grasp, file)
    names = (result.scene, result.task, result.robot)
    if open_page and out is None:
        raise pinograsp.InputError("needs a page", key="--open", remedy="Give the folder of the page with --out")
    terminal.find(lambda: _document(result, grasp, chosen), lambda: _report(result, grasp, chosen, terminal))
    if out is not None:
        make_folder(out)
        page = out / file_name(*names, f"grasp{grasp}", suffix="html")
        terminal.say(save(page, lambda: pinograsp.visualization.write_html(chosen, page)))
        if open_page:
            typer.launch(str(page))


def _document(result: pinograsp.Result, number: int, grasp: pinograsp.Grasp) -> dict[str, object]:
    names = {"robot": result.robot, "scene": result.scene, "task": result.task}
    return {**names, "number": number, "grasp": grasp.to_json()}


def _report(result: pinograsp.Result, number: int, grasp: pinograsp.Grasp, terminal: Terminal) -> None:
    from ..results.table import contacts_table, figures_table

    found = f"found by {grasp.count} {'start' if grasp.count == 1 else 'starts'}"
    where = f"grasp {number} of {len(result.grasps)}: {result.task}, {result.robot} in {result.scene}"
    terminal.say(f"{typer.style(where, bold=True)}; {found}")
    distances = f"distances {grasp.cost.phi_mm2:.4f} mm^2"
    if result.setup.scene.task(result.task).desired_contacts is None:
        distances = "no contacts desired"
    terminal.say(f"U {grasp.cost.U:.4f}: {distances}, forces V {grasp.cost.V:.4f}")
    terminal.say("")
    terminal.say("joints, rad (m):")
    widest = max(map(len, grasp.joints))
    for name, value in grasp.joints.items():
        terminal.say(f"  {name:{widest}} {value:9.4f}")
    terminal.say("")
    terminal.table(contacts_table(grasp.contacts, "contacts, in the world"))
    terminal.say("")
    terminal.table(figures_table(grasp.certificate.figures, "certificate"))
