"""Formulas as MathML: written in LaTeX, translated when the pages are built, drawn by the browser itself.

A page needs no script for them, and takes the font for mathematics that the system has.
"""

from __future__ import annotations

import html
import re
from typing import Any

from latex2mathml.converter import convert
from mkdocs.exceptions import PluginError

_FORMULA = re.compile(
    r'<(?P<element>span|div) class="arithmatex">\\[(\[](?P<latex>.*?)\\[)\]]</(?P=element)>', re.DOTALL
)
_NUMBER = re.compile(r"\\tag\{([^}]*)\}")
_UNKNOWN = re.compile(r">(\\[A-Za-z]+)<")


def on_page_content(content: str, **_: Any) -> str:
    r"""Return the HTML of a page with MathML in place of LaTeX; `\tag{8}` numbers a displayed formula as the paper."""
    return _FORMULA.sub(_formula, content)


def _formula(found: re.Match[str]) -> str:
    latex = html.unescape(found["latex"]).strip()
    if found["element"] == "span":
        return _mathml(latex, "inline")
    number = _NUMBER.search(latex)
    label = f'<span class="formula-number">({html.escape(number[1])})</span>' if number else ""
    return f'<div class="formula">{_mathml(_NUMBER.sub("", latex), "block")}{label}</div>'


def _mathml(latex: str, display: str) -> str:
    mathml = str(convert(latex, display=display))
    unknown = _UNKNOWN.search(mathml)
    if unknown:
        raise PluginError(f"no translation of {unknown[1]} in the formula {latex}")
    return mathml
