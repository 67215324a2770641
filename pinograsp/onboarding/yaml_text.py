"""Names as a YAML file has to write them, so that they are read as the texts that they are."""

from __future__ import annotations

import re
from collections.abc import Iterable

import yaml

from ..descriptions.yaml_core import Yaml

_PLAIN = re.compile(r"[^\W\d][\w.+/-]*(://[\w.+/-]*)?|\.{1,2}/[\w.+/-]*")
"""What needs no quotes anywhere, in a list between brackets neither, unless it is a word or number of YAML."""
_WORDS = {"y", "n"}
"""Truths of YAML 1.1 that PyYAML does not know."""


def text(name: str) -> str:
    """Return a text as YAML 1.1 and 1.2 read it: plain, or between quotes."""
    plain = _PLAIN.fullmatch(name) and name.lower() not in _WORDS
    # What is plain and no word of YAML is read as itself.
    if plain and all(yaml.load(name, loader) == name for loader in (yaml.SafeLoader, Yaml)):
        return name
    escaped = (f"\\{c}" if c in '"\\' else c if c.isprintable() else f"\\U{ord(c):08X}" for c in name)
    return f'"{"".join(escaped)}"'


def texts(names: Iterable[str]) -> str:
    """Return texts as a list between brackets."""
    return f"[{', '.join(map(text, names))}]"
