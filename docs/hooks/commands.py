"""The command line as Markdown, from the commands themselves."""

from __future__ import annotations

import inspect
import re
import textwrap
from typing import Any

import typer

from pinograsp.cli import app


def commands() -> str:
    """Return a section for every command, with its usage, a table of its options, and its examples."""
    return "\n\n".join(_command("pinograsp", typer.main.get_command(app), level=2))


def _command(name: str, command: Any, level: int) -> list[str]:
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    options = [p for p in command.params if p.param_type_name == "option" and not getattr(p, "hidden", False)]
    children = getattr(command, "commands", {})
    words = [name, *(p.metavar or p.name.upper() for p in arguments), "COMMAND" if children else "", "[OPTIONS]"]
    parts = [
        f"{'#' * level} {name} {{ #{name.replace(' ', '-')} }}",
        _text(command.help),
        "```text\n" + " ".join(word for word in words if word) + "\n```",
    ]
    rows = [_row(p.metavar or p.name.upper(), p) for p in arguments] + [_row(_flags(p), p) for p in options]
    if rows:
        table = ["| argument or option | default | meaning |", "|---|---|---|", *rows]
        parts.append('<div class="keys" markdown>\n\n' + "\n".join(table) + "\n\n</div>")
    parts.append(_text(command.epilog))
    for child, inner in children.items():
        parts += _command(f"{name} {child}", inner, level=3)
    return [part for part in parts if part]


def _flags(option: Any) -> str:
    flags = ", ".join([*option.opts, *option.secondary_opts])
    return f"{flags} {option.metavar}" if option.metavar else flags


def _row(name: str, parameter: Any) -> str:
    help_text = _plain(" ".join((getattr(parameter, "help", "") or "").split())).replace("|", "\\|")
    return f"| `{name}` | {_default(parameter)} | {help_text} |"


def _default(parameter: Any) -> str:
    if parameter.required:
        return "required"
    shown = getattr(parameter, "show_default", False)
    if isinstance(shown, str):
        return shown
    default = parameter.default
    if default is None or callable(default) or isinstance(default, bool) or default in ((), []):
        return ""
    values = default if isinstance(default, (tuple, list)) else (default,)
    return "`" + " ".join(f"{value:g}" if isinstance(value, float) else str(value) for value in values) + "`"


def _text(help_text: str | None) -> str:
    r"""Return a help text as Markdown; `\b` begins a paragraph whose lines stay as they are: a title and examples."""
    paragraphs = inspect.cleandoc(help_text or "").split("\n\n")
    return "\n\n".join(
        _examples(text.removeprefix("\b\n")) if text.startswith("\b\n") else _plain(text) for text in paragraphs
    )


def _examples(text: str) -> str:
    title, _, lines = text.partition("\n")
    return f"{title}\n\n```sh\n{textwrap.dedent(lines)}\n```"


def _plain(text: str) -> str:
    """Return a text with names of files that have a part in angle brackets as code: as HTML they would vanish."""
    return re.sub(r"[\w/.]*<\w+>[\w<>/]*(?:\.\w+)?", r"`\g<0>`", text)
