"""A page of headings, text, tables and pictures, written as Markdown and as one self-contained HTML file.

Texts are plain, except that `backquotes` set code.
"""

from __future__ import annotations

import base64
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from pinograsp.disk import write_whole

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #1c2430; max-width: 1180px; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; } h2 { font-size: 1.3rem; margin-top: 2.4rem; border-bottom: 1px solid #d5dbe2; }
h3 { font-size: 1.05rem; margin-top: 1.6rem; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: 13px; margin: .8rem 0; }
th, td { padding: .28rem .55rem; text-align: left; vertical-align: top; border-bottom: 1px solid #e4e8ed; }
th { background: #f2f5f8; } .number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
code { font-size: .92em; background: #f2f5f8; padding: 0 .2em; }
figure { margin: 1rem 0; } figcaption { color: #55606e; font-size: 13px; } img { max-width: 100%; }
.side { display: grid; grid-template-columns: repeat(auto-fit, minmax(30rem, 1fr)); gap: 0 1.2rem; }
"""
NUMBER = re.compile(r"-?\d[\d.,e+-]*( (%|h|s|ms))?( \([\d.]+ %\))?")
"""What a cell holds in a column that is set flush right."""


@dataclass(frozen=True)
class Heading:
    """A heading of level 1, 2 or 3."""

    level: int
    text: str


@dataclass(frozen=True)
class Text:
    """A paragraph."""

    text: str


@dataclass(frozen=True)
class Table:
    """A table; every row has a cell for each column."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Pictures:
    """PNG files with captions, side by side where there is room."""

    files: Sequence[tuple[Path, str]]


Block = Heading | Text | Table | Pictures


def write_page(folder: Path, name: str, title: str, blocks: Sequence[Block]) -> tuple[Path, Path]:
    """Write `name`.md and `name`.html into a folder, return both files.

    The pictures must lie below the folder: Markdown refers to them by relative path.
    """
    files = folder / f"{name}.md", folder / f"{name}.html"
    texts = (
        "\n\n".join(_markdown(block, folder) for block in [Heading(1, title), *blocks]) + "\n",
        f"<!doctype html>\n<html lang='en'><head><meta charset='utf-8'><title>{escape(title)}</title>"
        f"<style>{STYLE}</style></head><body>\n"
        + "\n".join(_html(block) for block in [Heading(1, title), *blocks])
        + "\n</body></html>\n",
    )
    for file, text in zip(files, texts, strict=True):
        write_whole(file, text)
    return files


def _markdown(block: Block, folder: Path) -> str:
    match block:
        case Heading(level, text):
            return f"{'#' * level} {text}"
        case Text(text):
            return text
        case Table(head, rows):
            lines = [head, ["---"] * len(head), *rows]
            return "\n".join("| " + " | ".join(cell.replace("|", r"\|") for cell in line) + " |" for line in lines)
        case Pictures(files):
            return "\n\n".join(
                f"![{caption}]({Path(os.path.relpath(file, folder)).as_posix()})\n\n*{caption}*"
                for file, caption in files
            )


def _html(block: Block) -> str:
    match block:
        case Heading(level, text):
            return f"<h{level}>{_inline(text)}</h{level}>"
        case Text(text):
            return f"<p>{_inline(text)}</p>"
        case Table(head, rows):
            sides = [_side([row[i] for row in rows]) for i in range(len(head))]
            top = _row("th", head, sides)
            body = "".join(_row("td", row, sides) for row in rows)
            return f"<div class='wide'><table><thead>{top}</thead><tbody>{body}</tbody></table></div>"
        case Pictures(files):
            figures = (
                f"<figure><img alt='{escape(caption, quote=True)}' src='{_embedded(file)}'>"
                f"<figcaption>{_inline(caption)}</figcaption></figure>"
                for file, caption in files
            )
            return f"<div class='side'>{''.join(figures)}</div>"


def _row(tag: str, cells: Sequence[str], sides: Sequence[str]) -> str:
    inside = "".join(f"<{tag}{side}>{_inline(cell)}</{tag}>" for cell, side in zip(cells, sides, strict=True))
    return f"<tr>{inside}</tr>"


def _side(column: Sequence[str]) -> str:
    """Return the attribute that sets a column of numbers flush right."""
    numbers = all(NUMBER.fullmatch(cell) for cell in column if cell not in {"", "-"})
    return " class='number'" if numbers else ""


def _inline(text: str) -> str:
    return re.sub(r"`([^`]*)`", r"<code>\1</code>", escape(text, quote=False))


def _embedded(file: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode("ascii")
