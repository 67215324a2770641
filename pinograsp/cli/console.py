"""Lines in the terminal."""

from __future__ import annotations

from rich.console import Console


def say(console: Console, line: str) -> None:
    """Print one line as it is, however narrow the terminal: paths stay whole."""
    console.print(line, highlight=False, soft_wrap=True)
