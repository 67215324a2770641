"""The whole command line: all commands, and an exit code and one line for every error."""

from __future__ import annotations

import gc
import sys
import traceback
from typing import Annotated, Any

import typer

import pinograsp

from ..errors import PinograspError
from . import assess, check, contacts, database, hold, listing, plan, rank, robot, show, verify, why
from .arguments import FAULT, WRONG_USE, group, help_alone
from .terminal import fail, spelled_streams

SELDOM = 100_000
"""New objects after which garbage is looked for: what is loaded and read stays, and looking would take an eighth of the
time of commands that read."""

app = group()


@app.callback(invoke_without_command=True)
def pinograsp_command(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Plan verified grasps for a robot arm and hand inside a narrow enclosure.

    Exit codes: 0 grasps were found, everything stands or holds; 1 none was found, something differs or does not
    hold; 2 the input cannot be used; 70 a fault of pinograsp itself; 130 interrupted with Ctrl-C, 143 with
    SIGTERM.
    """
    if version:
        typer.echo(f"pinograsp {pinograsp.__version__}")
        raise typer.Exit
    help_alone(context)


for module in (plan, why, check, contacts, rank, show, verify, assess, hold, robot, database, listing):
    module.register(app)


def main() -> None:
    """Run the command line and end the process; errors that the user can mend are one line, without a traceback."""
    thresholds = gc.get_threshold()
    gc.set_threshold(SELDOM, *thresholds[1:])
    try:
        with spelled_streams():
            code = _run()
    finally:
        gc.set_threshold(*thresholds)
    raise SystemExit(code)


def _run() -> int:
    try:
        return app(prog_name="pinograsp", standalone_mode=False) or 0
    except typer.TyperException as error:  # wrong use
        fail(_usage(error))
    except PinograspError as error:
        fail(str(error))
    except Exception:  # with the traceback for who mends it
        fail(f"a fault of pinograsp itself; please report it with these lines:\n{traceback.format_exc().rstrip()}")
        return FAULT
    return WRONG_USE


def _usage(error: typer.TyperException) -> str:
    """Return the line of a wrong use, with the command whose help says more."""
    context = getattr(error, "ctx", None)
    said = " ".join(error.format_message().split()).rstrip(".")
    return f"{said[:1].lower()}{said[1:]}. See {context.command_path if context else _command_path()} --help"


def _command_path() -> str:
    """Return the command that was asked for; some errors of its options do not know it."""
    commands: Any = typer.main.get_command(app)
    path = ["pinograsp"]
    for word in sys.argv[1:]:
        commands = getattr(commands, "commands", {}).get(word)
        if commands is None:
            break
        path.append(word)
    return " ".join(path)
