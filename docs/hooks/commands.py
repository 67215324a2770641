"""The command line as Markdown, from the commands themselves."""

from __future__ import annotations

import inspect
from typing import Any

import typer

from pinograsp import cli


def commands() -> str:
    """Return a section for every command, with its usage and a table of its options."""
    return "\n\n".join(_command("pinograsp", typer.main.get_command(cli.app), level=2))


def _command(name: str, command: Any, level: int) -> list[str]:
    parts = [f"{'#' * level} {name} {{ #{name.replace(' ', '-')} }}", _text(command.help)]
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    options = [p for p in command.params if p.param_type_name == "option" and not getattr(p, "hidden", False)]
    children = getattr(command, "commands", {})
    words = [name, *(p.name.upper() for p in arguments), "COMMAND" if children else ""]
    parts.append("```text\n" + " ".join(word for word in [*words, "[OPTIONS]"] if word) + "\n```")
    rows = [_row(p.name.upper(), p) for p in arguments] + [_row(_flags(p), p) for p in options]
    if rows:
        table = ["| argument or option | default | meaning |", "|---|---|---|", *rows]
        parts.append('<div class="keys commands" markdown>\n\n' + "\n".join(table) + "\n\n</div>")
    parts.append(_text(command.epilog))
    for child, inner in children.items():
        parts += _command(f"{name} {child}", inner, level + (name == "pinograsp"))
    return [part for part in parts if part]


def _flags(option: Any) -> str:
    return ", ".join(f"{flag}" for flag in [*option.opts, *option.secondary_opts])


def _row(name: str, parameter: Any) -> str:
    help_text = " ".join((getattr(parameter, "help", "") or "").split()).replace("|", "\\|")
    return f"| `{name}` | {_default(parameter)} | {help_text} |"


def _default(parameter: Any) -> str:
    if parameter.required:
        return "required"
    shown = getattr(parameter, "show_default", False)
    if isinstance(shown, str):
        return f"`{shown}`"
    default = parameter.default
    if default is None or callable(default) or isinstance(default, bool) or default in ((), []):
        return ""
    values = default if isinstance(default, (tuple, list)) else (default,)
    return "`" + " ".join(f"{value:g}" if isinstance(value, float) else str(value) for value in values) + "`"


def _text(help_text: str | None) -> str:
    r"""Return a help text as Markdown; `\b` begins a paragraph whose lines stay as they are: an example."""
    paragraphs = inspect.cleandoc(help_text or "").split("\n\n")
    return "\n\n".join(
        "```sh\n" + inspect.cleandoc(text.removeprefix("\b\n")) + "\n```" if text.startswith("\b\n") else text
        for text in paragraphs
    )
