"""The command line of written results: `pinograsp verify`."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress

from ..results import Result, read_json
from ..results.reverify import Difference, verify
from .console import say

DIFFERENT = 1


def verify_command(
    file: Annotated[Path, typer.Argument(help="JSON file of a result.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the differences as JSON.")] = False,
) -> None:
    """Recompute every certificate of a result from its file alone, and say what differs.

    Exits with 0 if every certificate stands, 1 if anything differs.
    """
    console = Console()
    result = read_json(file)
    found = _recomputed(result, console)
    if as_json:
        differences = [dataclasses.asdict(difference) for difference in found]
        typer.echo(json.dumps({"grasps": len(result.grasps), "differences": differences}, indent=1))
    else:
        for difference in found:
            say(console, escape(_line(difference)))
        say(console, _summary(result, found))
    if found:
        raise typer.Exit(DIFFERENT)


def _recomputed(result: Result, console: Console) -> tuple[Difference, ...]:
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        row = bar.add_task("certificates", total=len(result.grasps))
        return verify(result, progress=lambda done: bar.update(row, completed=done))


def _line(difference: Difference) -> str:
    whose = "result" if difference.grasp is None else f"grasp {difference.grasp}"
    stated, recomputed = json.dumps(difference.stated), json.dumps(difference.recomputed)
    return f"{whose}: {difference.what}: {stated} stated, {recomputed} recomputed"


def _summary(result: Result, found: tuple[Difference, ...]) -> str:
    count = len(result.grasps)
    grasps = f"{count} {'grasp' if count == 1 else 'grasps'} recomputed"
    if not found:
        return f"{grasps}: every certificate stands"
    return f"[bold red]{grasps}: {len(found)} {'difference' if len(found) == 1 else 'differences'}[/]"
