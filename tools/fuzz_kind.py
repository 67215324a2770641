"""What a kind of files is, and what the kinds share: how a tree is written, and that numbers are finite."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from fuzz_mutations import mutate_bytes, mutate_tree

RAW = 0.15
"""Share of the inputs whose bytes are changed, not their structure."""
Dumper: Any = getattr(yaml, "CDumper", yaml.Dumper)


class SilentNaNError(Exception):
    """A number that is not finite where nothing says so."""


@dataclass(frozen=True)
class Kind:
    """One kind of files."""

    make: Callable[[Path, random.Random], None]
    """Writes an input to an empty folder."""
    use: Callable[[Path], None]
    """Does with the input in a folder what a user does."""
    command: Callable[[Path], list[str]] | None = None
    """Arguments of a command that reads it."""
    share: int = 20
    """Of all inputs, as against the others: few of what takes long."""


def written(file: Path, tree: Any, rng: random.Random) -> None:
    """Write a mutated tree; of some only the bytes are changed, or the tree says things twice."""
    if rng.random() >= RAW:
        mutate_tree(tree, rng)
    text = json.dumps(tree, separators=(",\n", ": ")) if file.suffix == ".json" else yaml_text(tree)
    data = text.encode("utf-8", "surrogatepass")
    file.write_bytes(mutate_bytes(data, rng) if rng.random() < RAW else data)


def yaml_text(tree: Any) -> str:
    """Return a tree as YAML."""
    return str(yaml.dump(tree, Dumper=Dumper, sort_keys=False, allow_unicode=True))


def require_finite(data: Any, what: str) -> None:
    """Refuse a number that is not finite, anywhere in data.

    Raises:
        SilentNaNError: there is one.
    """
    for number in _numbers(data):
        if not math.isfinite(number):
            raise SilentNaNError(what)


def _numbers(data: Any) -> Iterator[float]:
    if isinstance(data, Mapping):
        data = list(data.values())
    if isinstance(data, list | tuple):
        for part in data:
            yield from _numbers(part)
    elif isinstance(data, float):
        yield data
