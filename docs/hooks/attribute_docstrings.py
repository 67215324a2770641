"""The strings below the attributes of classes, which say what they mean."""

from __future__ import annotations

import ast
from pathlib import Path

Docstrings = dict[str, dict[str, str]]
"""By name of the class and of the attribute; those of base classes included."""


def attribute_docstrings(folder: Path) -> Docstrings:
    """Return the strings of all classes in the Python files below a folder."""
    own: Docstrings = {}
    bases: dict[str, list[str]] = {}
    for file in sorted(folder.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                own.setdefault(node.name, {}).update(_attributes(node))
                bases[node.name] = [base.id for base in node.bases if isinstance(base, ast.Name)]
    return {name: _inherited(name, own, bases) for name in own}


def _attributes(node: ast.ClassDef) -> dict[str, str]:
    found = {}
    for statement, after in zip(node.body, node.body[1:], strict=False):
        documented = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        if isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name) and documented:
            found[statement.target.id] = " ".join(str(after.value.value).split())
    return found


def _inherited(name: str, own: Docstrings, bases: dict[str, list[str]]) -> dict[str, str]:
    found: dict[str, str] = {}
    for base in reversed(bases.get(name, [])):
        found |= _inherited(base, own, bases)
    return found | own.get(name, {})
