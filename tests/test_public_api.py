"""The public face: its names, and what their documentation owes to whoever reads it."""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, get_args, get_type_hints

import pytest
from pydantic import BaseModel

import pinograsp

STUB = Path(pinograsp.__file__).with_suffix(".pyi")
SUBMODULES = ["visualization"]
OWN = [name for name in pinograsp.__all__ if not name.startswith("_") and name not in SUBMODULES]
UNIT = re.compile(
    r"(?<![\w'])(m|mm|mm\^2|N|N m|N mm|rad|rad/s\^2|degrees?|kg|s|[Ss]econds?|m/s\^2|m\^3|bytes|N/m|N m/rad|%)(?![\w'])"
)
"""A unit, as docstrings write it."""
UNITLESS = re.compile(
    r"\b(coefficient|factor|share|parts?|unit vectors?|length 1|no unit|pure number)\b|`unit`", re.IGNORECASE
)
"""Words for quantities that have none, and for those that say it beside themselves."""
PARTS = {
    "Attachment": "a part of a robot file",
    "ArmDescription": "a part of a robot file",
    "CollisionDescription": "a part of a robot file",
    "HandDescription": "a part of a robot file",
    "PadDescription": "a part of a robot file",
    "ShapeDescription": "the base of Sphere, Box, Cylinder and meshes",
    "StiffnessDescription": "a part of a robot file",
    "UrdfFiles": "a part of a robot file",
}
"""Classes in public annotations that have no public name, and why; `docs/formats` describes the parts of files."""
QUANTITY = re.compile(
    r"\b(float|Array|\w*Vector3|\w*Interval|Numbers?|Rows|\w*Points|Ranges|Sizes3|Positive|NotNegative|Length)\b"
)
"""Annotations of what may have a unit."""


@dataclass(frozen=True)
class Documented:
    """Something that a reader looks up: what it is called, what says what it is, and whether a unit is due."""

    name: str
    text: str
    quantity: bool
    has_own: bool


def _functions() -> Iterator[Documented]:
    for name in (*OWN, *(f"visualization.{name}" for name in pinograsp.visualization.__all__)):
        value = _value(name)
        if inspect.isfunction(value):
            yield _function(name, value)


def _classes() -> Iterator[Documented]:
    for name in OWN:
        value = _value(name)
        if inspect.isclass(value):
            yield Documented(name, inspect.getdoc(value) or "", False, bool(vars(value).get("__doc__")))
            yield from _members(name, value)


def _value(name: str) -> Any:
    value: Any = pinograsp
    for part in name.split("."):
        value = getattr(value, part)
    return value


def _function(name: str, function: Any) -> Documented:
    signature = inspect.signature(function)
    kinds = [str(signature.return_annotation), *(str(p.annotation) for p in signature.parameters.values())]
    text = inspect.getdoc(function) or ""
    return Documented(name, text, any(QUANTITY.search(kind) for kind in kinds), bool(function.__doc__))


def _members(name: str, defined: type) -> Iterator[Documented]:
    """Yield methods, properties and fields that the package itself defines, those of base classes included."""
    seen: set[str] = set()
    for base in defined.__mro__:
        if not base.__module__.startswith("pinograsp") or base.__name__ in {"Frozen", "FileRoot"}:
            continue
        body = ast.parse(textwrap.dedent(inspect.getsource(base))).body[0]
        assert isinstance(body, ast.ClassDef)
        about = inspect.getdoc(base) or ""
        for part, following in zip(body.body, [*body.body[1:], None], strict=True):
            if isinstance(part, ast.FunctionDef) and not part.name.startswith("_") and part.name not in seen:
                seen.add(part.name)
                kinds = [ast.unparse(a.annotation) for a in (*part.args.args, *part.args.kwonlyargs) if a.annotation]
                kinds += [ast.unparse(part.returns)] if part.returns else []
                own = ast.get_docstring(part) or ""
                quantity = any(QUANTITY.search(kind) for kind in kinds)
                yield Documented(f"{name}.{part.name}", f"{own} {about}", quantity, bool(own))
            elif isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name):
                field = part.target.id
                if field.startswith("_") or field in seen:
                    continue
                seen.add(field)
                own = ""
                if isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant):
                    own = str(following.value.value)
                quantity = bool(QUANTITY.search(ast.unparse(part.annotation)))
                yield Documented(f"{name}.{field}", f"{own} {about}", quantity, bool(own) or _is_tag(part))


def _is_tag(field: ast.AnnAssign) -> bool:
    """Whether it can have one value only, the name of its class in files: `type` of a shape."""
    return ast.unparse(field.annotation).startswith("Literal['") and "," not in ast.unparse(field.annotation)


FUNCTIONS = list(_functions())
CLASSES = list(_classes())
QUANTITIES = [documented for documented in (*FUNCTIONS, *CLASSES) if documented.quantity]


def test_names_are_those_of_the_stub() -> None:
    """Type checkers, `dir`, `import *` and the lazy loader agree."""
    imported = {
        alias.asname: alias.name
        for node in ast.parse(STUB.read_text()).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert all(name == original for name, original in imported.items())
    assert sorted(imported) == sorted(pinograsp.__all__) == sorted(dir(pinograsp))
    assert [name for name in pinograsp.__all__ if name.startswith("_")] == ["__version__"]
    assert (STUB.parent / "py.typed").is_file()


def test_no_module_and_no_name_of_another_package_leaks() -> None:
    modules = [name for name in pinograsp.__all__ if isinstance(getattr(pinograsp, name), ModuleType)]
    assert modules == SUBMODULES
    for name in OWN:
        value = getattr(pinograsp, name)
        module = getattr(value, "__module__", type(value).__module__)
        assert module.startswith("pinograsp") or name == "CRITERIA", f"{name} comes from {module}"
    assert all(type(criterion) is pinograsp.Criterion for criterion in pinograsp.CRITERIA)


def _annotated(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield what is annotated, and its annotations: parameters, results, fields, properties and methods."""
    if inspect.isfunction(value):
        yield name, value
        return
    for base in value.__mro__ if inspect.isclass(value) else ():
        if not base.__module__.startswith("pinograsp"):
            continue
        yield name, base
        for key, member in list(vars(base).items()):
            member = getattr(member, "__func__", getattr(member, "fget", getattr(member, "func", member)))
            if inspect.isfunction(member) and (not key.startswith("_") or key == "__init__"):
                yield f"{name}.{key}", member


def _classes_in(annotation: Any) -> Iterator[type]:
    if isinstance(annotation, list | tuple):
        parts = annotation
    else:
        parts = get_args(annotation)
        if not parts and inspect.isclass(annotation):
            yield annotation
    for part in parts:
        yield from _classes_in(part)


def test_classes_of_public_annotations_are_public() -> None:
    """What a public call takes or returns has a public name; a protocol stands for whatever has its attributes."""
    values = {name: _value(name) for name in OWN}
    values |= {name: _value(f"visualization.{name}") for name in pinograsp.visualization.__all__}
    public = {id(value) for value in values.values()}
    found: dict[str, set[str]] = {}
    for name, value in values.items():
        for where, annotated in _annotated(name, value):
            for key, annotation in get_type_hints(annotated).items():
                for kind in () if key.startswith("_") else _classes_in(annotation):
                    own = kind.__module__.startswith("pinograsp") and not getattr(kind, "_is_protocol", False)
                    if own and id(kind) not in public:
                        found.setdefault(kind.__name__, set()).add(f"{where}: {key}")
    assert {name: places for name, places in found.items() if name not in PARTS} == {}
    assert PARTS.keys() <= found.keys()


def test_every_name_is_a_class_a_function_or_a_constant_with_its_own_docstring() -> None:
    for name in OWN:
        value = getattr(pinograsp, name)
        if not name.isupper():
            assert inspect.isclass(value) or inspect.isfunction(value), name
            assert value.__name__ == name


@pytest.mark.parametrize("documented", [*FUNCTIONS, *CLASSES], ids=lambda documented: documented.name)
def test_documented(documented: Documented) -> None:
    assert documented.has_own, f"{documented.name} has no docstring"
    first = documented.text.lstrip()
    assert not first.startswith("What "), f"{documented.name}: {first[:60]!r}: say the noun"


@pytest.mark.parametrize("documented", QUANTITIES, ids=lambda documented: documented.name)
def test_units_are_given(documented: Documented) -> None:
    """Whatever takes, returns or is a number with a fraction, or an array, has a unit, or a word that it has none."""
    text = documented.text
    assert UNIT.search(text) or UNITLESS.search(text), f"{documented.name}: in which unit?\n{text}"


@pytest.mark.parametrize("name", [documented.name for documented in FUNCTIONS])
def test_parameters_are_documented(name: str) -> None:
    """A function of more than one parameter has a line on each; one of a single parameter may say it in its text."""
    function = _value(name)
    parameters = list(inspect.signature(function).parameters)
    text = inspect.getdoc(function) or ""
    if len(parameters) > 1:
        missing = [parameter for parameter in parameters if not re.search(rf"^ +{parameter}: ", text, re.MULTILINE)]
        assert not missing, f"{name} does not say what these are: {', '.join(missing)}"


def test_parameters_of_public_methods_are_documented() -> None:
    for name in OWN:
        defined = getattr(pinograsp, name)
        if not inspect.isclass(defined):
            continue
        for method, function in list(vars(defined).items()):
            function = getattr(function, "__func__", function)
            if method.startswith("_") or hasattr(BaseModel, method) or not inspect.isfunction(function):
                continue
            parameters = [p for p in inspect.signature(function).parameters if p not in {"self", "cls"}]
            text = inspect.getdoc(function) or ""
            missing = [p for p in parameters if not re.search(rf"^ +{p}: ", text, re.MULTILINE)]
            assert len(parameters) <= 1 or not missing, f"{name}.{method}: {', '.join(missing)}"


def test_files_are_given_as_texts_or_paths() -> None:
    """Wherever a path may be given, its text may be."""
    functions = {name: _value(name) for name in (documented.name for documented in FUNCTIONS)}
    for name in OWN:
        defined = getattr(pinograsp, name)
        if inspect.isclass(defined) and not issubclass(defined, (BaseException, BaseModel)):
            functions[name] = defined
            members = {f"{name}.{key}": getattr(value, "__func__", value) for key, value in vars(defined).items()}
            functions |= {
                key: value
                for key, value in members.items()
                if inspect.isfunction(value) and not value.__name__.startswith("_")
            }
    for name in functions.keys() - {"Database"}:  # which holds a file that is open
        for parameter in inspect.signature(functions[name]).parameters.values():
            kinds = re.split(r"\W+", str(parameter.annotation))
            assert "Path" not in kinds or "str" in kinds, f"{name}: {parameter}"
