"""YAML with the words and numbers of YAML 1.2, its "core schema": https://yaml.org/spec/1.2.2/#103-core-schema.

PyYAML reads YAML 1.1, where 1:30 is 90, 010 is 8, 1_0 is 10, 1e-3 is a text, and `on`, `no` and dates are no texts.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING

import yaml

if TYPE_CHECKING or not yaml.__with_libyaml__:
    from yaml import SafeLoader
else:  # eight times as fast, and it refuses the same but for tabs between words, which YAML 1.2 allows
    from yaml import CSafeLoader as SafeLoader

_TAG = "tag:yaml.org,2002:"
_NOT_FINITE = re.compile(r"([-+]?)\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_WORDS = {
    "null": (r"~|null|Null|NULL|", "~nN"),
    "bool": (r"true|True|TRUE|false|False|FALSE", "tTfF"),
    "int": (r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+", "-+0123456789"),
    "float": (
        rf"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|{_NOT_FINITE.pattern}",
        "-+.0123456789",
    ),
    "merge": (r"<<", "<"),  # of YAML 1.1: files repeat what they share with it
}
"""By tag: what is read as one, and the characters that it begins with. The first that fits counts."""


class Yaml(SafeLoader):
    """A loader for `yaml.load`; plain scalars that are no word or number of YAML 1.2 are texts."""

    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}  # noqa: RUF012 - as PyYAML has it


LONGEST_INT = 100
"""Characters of a whole number; of much longer ones Python refuses even to show the digits."""


def _int(loader: Yaml, node: yaml.ScalarNode) -> int:
    text = str(loader.construct_scalar(node))
    if len(text) > LONGEST_INT:
        problem = f"a number of {len(text)} digits cannot be meant"
        raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)
    return int(text, 0) if text.startswith(("0o", "0x")) else int(text)


def _float(loader: Yaml, node: yaml.ScalarNode) -> float:
    text = str(loader.construct_scalar(node))
    return float(text.replace(".", "")) if _NOT_FINITE.fullmatch(text) else float(text)


def _set_up() -> None:
    for word, (pattern, beginnings) in _WORDS.items():
        first = [*beginnings, ""] if word == "null" else list(beginnings)
        Yaml.add_implicit_resolver(_TAG + word, re.compile(rf"(?:{pattern})\Z"), first)
    numbers: dict[str, Callable[[Yaml, yaml.ScalarNode], float]] = {"int": _int, "float": _float}
    for word, read in numbers.items():
        Yaml.add_constructor(_TAG + word, read)


_set_up()


MOST_REPEATED = 100_000
"""Values that aliases may repeat in a file."""


def require_few_aliases(root: yaml.Node) -> None:
    """Refuse a document that is short, but says so much by aliases of aliases that no memory holds it.

    Raises:
        yaml.YAMLError: it is one, or a part contains itself.
    """
    sizes: dict[yaml.Node, int | None] = {}

    def size(node: yaml.Node) -> int:
        """Return the number of values in a node, repeated ones each time."""
        if node in sizes:
            known = sizes[node]
            if known is None:
                raise yaml.composer.ComposerError(None, None, "a part contains itself", node.start_mark)
            return known
        sizes[node] = None
        sizes[node] = total = 1 + sum(map(size, _inside(node)))
        return total

    if size(root) - len(sizes) > MOST_REPEATED:
        problem = f"aliases repeat more than {MOST_REPEATED} values"
        raise yaml.composer.ComposerError(None, None, problem, root.start_mark)


def _inside(node: yaml.Node) -> list[yaml.Node]:
    if isinstance(node, yaml.MappingNode):
        return [part for pair in node.value for part in pair]
    return list(node.value) if isinstance(node, yaml.SequenceNode) else []
