"""The command line: `pinograsp plan | verify | assess | hold | robot | database | list | schema`."""

from __future__ import annotations

import json
from typing import Annotated, Literal

import typer
from rich.console import Console
from rich.markup import escape

from ..descriptions import load_robot_description, load_scene, schema, shipped_robots, shipped_scenes
from ..errors import InputError, MissingExtraError
from .assess import assess_command
from .console import say
from .database import app as database_app
from .hold import hold_command
from .plan import plan_command
from .robot import app as robot_app
from .verify import verify_command

BAD_INPUT = 2

app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False)


def main() -> None:
    """Run the command line; errors that the user can mend are one line, without a traceback."""
    try:
        app(prog_name="pinograsp")
    except (InputError, MissingExtraError) as error:
        say(Console(stderr=True), f"[bold red]error:[/] {escape(str(error))}")
        raise SystemExit(BAD_INPUT) from None


@app.callback()
def _commands() -> None:
    """Plan verified grasps for a robot arm and hand inside a narrow enclosure.

    Exit codes: 0 grasps were found, every certificate stands, or every grasp holds; 1 none was found, something
    differs, or one does not hold; 2 the input cannot be used; 130 interrupted.
    """


app.command("plan")(plan_command)
app.command("verify")(verify_command)
app.command("hold")(hold_command)
app.command("assess")(assess_command)
app.add_typer(database_app, name="database")
app.add_typer(robot_app, name="robot")


@app.command("schema")
def schema_command(
    kind: Annotated[Literal["robot", "scene"], typer.Argument(help="Which kind of file.")],
) -> None:
    """Print the JSON Schema of robot or scene files, for editors."""
    typer.echo(json.dumps(schema(kind), indent=2))


@app.command("list")
def list_command() -> None:
    """List the shipped robots and scenes, and the tasks of each scene."""
    for name, file in shipped_robots().items():
        typer.echo(f"robot {name}: {load_robot_description(file).description}")
    for name, file in shipped_scenes().items():
        scene = load_scene(file)
        typer.echo(f"scene {name}: {scene.description}; tasks: {', '.join(scene.tasks)}")
