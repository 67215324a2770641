"""Arguments and options that several commands have, and how a command is registered."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer

from ..errors import InputError
from ..interrupts import undisguised, watched
from . import completion
from .terminal import fail

WRONG_USE, FAULT = 2, 70
DEFAULT_ROBOT = "gen3_2f85"
POSE = ("X", "Y", "Z", "ROLL", "PITCH", "YAW")

Scene = Annotated[
    str,
    typer.Argument(metavar="SCENE", help="Scene file, or name of a shipped scene.", autocompletion=completion.scenes),
]
Task = Annotated[str, typer.Option(help="Name of a task of the scene.", autocompletion=completion.tasks)]
Robot = Annotated[
    str, typer.Option(help="Robot file or folder, or name of a shipped robot.", autocompletion=completion.robots)
]
RobotFile = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT", help="Robot file or folder, or name of a shipped robot.", autocompletion=completion.robots
    ),
]
ObjectPose = Annotated[
    tuple[str, float, float, float, float, float, float] | None,
    typer.Option(
        metavar=" ".join(("NAME", *POSE)),
        help="Put an object of the scene elsewhere: position in the world, m, and angles about its fixed axes, rad.",
        autocompletion=completion.objects,
    ),
]
Locks = Annotated[
    list[str] | None,
    typer.Option(metavar="JOINT=VALUE", help="Hold an arm joint or a synergy at a value, rad (m); can be repeated."),
]
ResultFile = Annotated[Path, typer.Argument(metavar="RESULT", help="Result: the JSON file of a plan.")]
GraspNumber = Annotated[int, typer.Option(metavar="NUMBER", help="Number of the grasp in the file's order, from 1.")]
Workers = Annotated[int | None, typer.Option(min=1, help="Processes.", show_default="one for each core")]
Out = Annotated[Path, typer.Option(metavar="FOLDER", help="Folder of the files that are written.")]
NoOut = Annotated[
    Path | None,
    typer.Option("--out", metavar="FOLDER", help="Folder to write into.", show_default="nothing is written"),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document instead.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only; files and exit code stay.")]

Function = TypeVar("Function", bound=Callable[..., None])


def command(app: typer.Typer, name: str, *examples: str) -> Callable[[Function], Function]:
    """Return a decorator that makes a function a command.

    Args:
        app: the command, or the group of commands, that it belongs to.
        name: of the command.
        examples: lines of a shell that its help ends with.
    """
    shown = "\n".join(["\b", "Examples:", *(f"  {example}" for example in examples)])

    def register(function: Function) -> Function:
        @functools.wraps(function)
        def interruptible(*arguments: Any, **options: Any) -> None:
            try:
                with watched() as asked, undisguised():
                    function(*arguments, **options)
            except KeyboardInterrupt:
                fail("interrupted")
                raise typer.Exit(asked.exit_code) from None

        app.command(name, epilog=shown)(interruptible)
        return function

    return register


def group() -> typer.Typer:
    """Return a group of commands, or the whole command line."""
    return typer.Typer(
        rich_markup_mode=None,  # plain text: no frames that leave words no room, and no time to load Rich
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )


def help_alone(context: typer.Context) -> None:
    """Print the help of a group of commands that was given no command, as the wrong use that it is."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help(), err=True)
        raise typer.Exit(WRONG_USE)


def named_values(texts: Sequence[str], option: str) -> dict[str, float]:
    """Return the numbers of texts such as `elbow=0.5`.

    Args:
        texts: as given.
        option: named in errors.

    Raises:
        InputError: a text is not of this kind, or its value is no number.
    """
    found = {}
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not (name and equals and math.isfinite(number)):
            raise InputError(f"{text!r} is not JOINT=VALUE", key=option, remedy="Give, for example, elbow=0.5")
        found[name] = number
    return found


def given(**options: Any) -> dict[str, Any]:
    """Return the options that were given; what the others are is for the library to say."""
    return {name: value for name, value in options.items() if value is not None}


def scaled(unit: float, number: float | None) -> float | None:
    """Return a number that may be given in a unit of the command line, in that of the library: so many to one."""
    return None if number is None else unit * number


@contextmanager
def as_options(options: Mapping[str, str]) -> Iterator[None]:
    """Give errors about arguments of the library the names that these have on the command line.

    Args:
        options: what is named in place of an argument: the option; where it has a unit of its own, as it was given.
    """
    try:
        yield
    except InputError as error:
        if error.key is None or error.key not in options:
            raise
        key = options[error.key]
        raise type(error)(error.problem, file=error.file, line=error.line, key=key, remedy=error.remedy) from None
