"""A result from JSON data, as `encoding` lays it out."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from ..arrays import Array
from ..descriptions import RobotDescription, Scene
from ..descriptions.model import FileRoot
from ..descriptions.problems import input_error
from ..errors import MOST, InputError
from ..verification.certificate import Certificate, Figure
from .explanation import Cause, Explanation, Remedy
from .grasp import Contact, Cost, Grasp
from .result import Blocked, Result
from .setup import Setup

Description = TypeVar("Description", bound=FileRoot)
Part = TypeVar("Part")
SHOWN = 60
"""Characters of what is wrong that an error shows."""


def decode(data: dict[str, Any]) -> Result:
    """Return the result in JSON data.

    Raises:
        InputError: something is missing or of another kind; the message names its key.
    """
    return Result(
        setup=_part(data, "setup", _setup),
        grasps=_parts(data, "grasps", _grasp),
        starts=_part(data, "starts", _count),
        counts=_named(data, "counts", _count),
        verified=_part(data, "verified", _count),
        refuted=_part(data, "refuted", _count),
        blocked=_named(data, "blocked", _blocked),
        interrupted=_part(data, "interrupted", _truth),
        warnings=_parts(data, "warnings", _text),
        explanation=_part(data, "explanation", _explanation) if "explanation" in data else None,
        times=_part(data, "times", _mapping),
        provenance=_part(data, "provenance", _provenance),
    )


def _part(data: Any, key: str | int, read: Callable[[Any], Part]) -> Part:
    """Return what is read from a part of JSON data.

    Raises:
        InputError: it is missing or cannot be read; the key is its path from `data` on.
    """
    step = f"[{key}]" if isinstance(key, int) else key
    try:
        part = data[key]
    except (IndexError, KeyError):
        raise InputError("this key is missing", key=step) from None
    except TypeError:
        raise InputError("this key is missing: there is no block of keys", key=step) from None
    try:
        return read(part)
    except InputError as error:
        inner = error.key or ""
        path = step + ("." if inner and not inner.startswith("[") else "") + inner
        raise InputError(error.problem, key=path, remedy=error.remedy) from None
    except (AttributeError, KeyError, OverflowError, TypeError, ValueError):
        raise InputError(f"cannot be used (given: {_shown(part)})", key=step) from None


def _parts(data: Any, key: str, read: Callable[[Any], Part]) -> tuple[Part, ...]:
    """Return what is read from each part of a list."""

    def each(parts: Any) -> tuple[Part, ...]:
        if not isinstance(parts, list):
            raise InputError(f"a list is wanted (given: {_shown(parts)})")
        return tuple(_part(parts, index, read) for index in range(len(parts)))

    return _part(data, key, each)


def _named(data: Any, key: str, read: Callable[[Any], Part]) -> dict[str, Part]:
    """Return what is read from each part of a block."""
    return _part(data, key, lambda block: {name: _part(block, name, read) for name in _mapping(block)})


def _made(kind: type[Part], data: Any, /, **read: Any) -> Part:
    """Return a record of JSON data that has all of its fields and no more, with those that were read already."""
    names = {field.name for field in dataclasses.fields(kind)}  # type: ignore[arg-type]
    if missing := sorted(names - data.keys()):
        raise InputError("this key is missing", key=missing[0])
    if strange := sorted(data.keys() - names):
        raise InputError("unknown key", key=strange[0])
    return kind(**{**data, **read})


def _shown(part: Any) -> str:
    """Return JSON data in few characters."""
    text = json.dumps(part)
    return text if len(text) <= SHOWN else text[:SHOWN] + " ..."


def _mapping(data: Any) -> dict[str, Any]:
    if not isinstance(data, dict):
        raise InputError(f"a block of keys is wanted (given: {_shown(data)})")
    return data


def _provenance(data: Any) -> dict[str, Any]:
    if "sha256" in _mapping(data):
        _part(data, "sha256", _mapping)
    return _mapping(data)


def _truth(data: Any) -> bool:
    if not isinstance(data, bool):
        raise InputError(f"true or false is wanted (given: {_shown(data)})")
    return data


def _text(data: Any) -> str:
    if not isinstance(data, str):
        raise InputError(f"a text is wanted (given: {_shown(data)})")
    return data


def _count(data: Any) -> int:
    if isinstance(data, bool) or not isinstance(data, int) or not 0 <= data <= MOST:
        raise InputError(f"a whole number from 0 to {MOST} is wanted (given: {_shown(data)})")
    return data


def _real(data: Any) -> float:
    if isinstance(data, bool) or not isinstance(data, int | float):
        raise InputError(f"a number is wanted (given: {_shown(data)})")
    number = float(data)
    if not math.isfinite(number):
        raise InputError(f"a finite number is wanted (given: {number})")
    return number


def _setup(data: Any) -> Setup:
    robot = _part(data, "robot", lambda part: _described(part, RobotDescription))
    scene = _part(data, "scene", lambda part: _described(part, Scene))
    task = _part(data, "task", _text)
    if task not in scene.tasks:
        raise InputError(f"the scene has no task {task!r}", key="task")
    return Setup(robot, scene, task)


def _described(data: Any, model: type[Description]) -> Description:
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise input_error(error, model, data) from None


def _grasp(data: Any) -> Grasp:
    return Grasp(
        start=_part(data, "start", _count),
        count=_part(data, "count", _count),
        joints=_named(data, "joints", _real),
        q_arm=_part(data, "q_arm", _array),
        synergy=_part(data, "synergy", _array),
        contact_parameters=_part(data, "contact_parameters", _array),
        internal_forces=_part(data, "internal_forces", _array),
        q_r=_named(data, "q_r", _real),
        cost=_part(data, "cost", _cost),
        contacts=_parts(data, "contacts", _contact),
        certificate=_part(data, "certificate", _certificate),
        T_world_wrist=_part(data, "T_world_wrist", _transform),
    )


def _cost(data: Any) -> Cost:
    return _made(Cost, data, **{name: _part(data, name, _real) for name in _mapping(data)})


def _blocked(data: Any) -> Blocked:
    return _made(Blocked, data, starts=_part(data, "starts", _count), nearest_miss=_part(data, "nearest_miss", _real))


def _explanation(data: Any) -> Explanation:
    return _made(
        Explanation,
        data,
        causes=_parts(data, "causes", _cause),
        nearest_miss=_part(data, "nearest_miss", lambda part: None if part is None else _grasp(part)),
        remedies=_parts(data, "remedies", _remedy),
        warnings=_parts(data, "warnings", _text),
        done=_part(data, "done", _count),
        verified=_part(data, "verified", _count),
        interrupted=_part(data, "interrupted", _truth),
        seconds=_part(data, "seconds", _real),
        refusal=_part(data, "refusal", _text),
    )


def _cause(data: Any) -> Cause:
    texts = {key: _part(data, key, _text) for key in ("kind", "unit", "where", "body")}
    numbers = {key: _part(data, key, _real) for key in ("share", "nearest_miss")}
    return _made(Cause, data, starts=_part(data, "starts", _count), **texts, **numbers)


def _remedy(data: Any) -> Remedy:
    texts = {key: _part(data, key, _text) for key in ("kind", "text", "unit")}
    counts = {key: _part(data, key, _count) for key in ("verified", "tried")}
    changes = _part(data, "changes", _mapping)
    return _made(Remedy, data, amount=_part(data, "amount", _real), changes=changes, **texts, **counts)


def _array(numbers: Any, *shape: int) -> Array:
    array = np.array(numbers)
    if array.dtype.kind not in "if" and array.size:  # texts, truth values, blocks, null
        raise InputError(f"numbers are wanted (given: {_shown(numbers)})")
    return np.asarray(array, dtype=np.float64).reshape(shape or -1)


def _vector(numbers: Any) -> Array:
    return _array(numbers, 3)


def _vector_or_none(numbers: Any) -> Array | None:
    return None if numbers is None else _vector(numbers)


def _transform(numbers: Any) -> Array:
    return _array(numbers, 4, 4)


def _contact(data: Any) -> Contact:
    vectors = {key: _part(data, key, _vector) for key in ("point", "normal", "force")}
    spin_torque, T = _part(data, "spin_torque", _real), _part(data, "T_world_pad", _transform)
    desired = _part(data, "desired_point", _vector_or_none)
    return _made(Contact, data, **vectors, desired_point=desired, spin_torque=spin_torque, T_world_pad=T)


def _certificate(data: Any) -> Certificate:
    return Certificate(_parts(data, "figures", _figure))


def _figure(data: Any) -> Figure:
    # null stands for a number that was not finite: a value that proves nothing, a limit that does not judge.
    unlimited = math.inf if _part(data, "sense", _text) == "at most" else -math.inf
    # Of a length that has to be large it is an overlap whose depth is not known.
    overlap = data.get("unit") == "m" and data["sense"] == "at least"
    unknown = -math.inf if overlap else math.nan
    value = _part(data, "value", lambda number: unknown if number is None else _real(number))
    limit = _part(data, "limit", lambda number: unlimited if number is None else _real(number))
    others = {key: part for key, part in data.items() if key != "holds"}  # which follows from the others
    return _made(Figure, others, value=value, limit=limit)
