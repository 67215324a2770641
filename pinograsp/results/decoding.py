"""A result from JSON data, as `encoding` lays it out."""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from ..arrays import Array
from ..descriptions import RobotDescription, Scene
from ..descriptions.model import FileRoot
from ..descriptions.problems import dotted
from ..errors import MOST
from ..verification.certificate import Certificate, Figure
from .grasp import Contact, Cost, Grasp
from .result import Blocked, Result
from .setup import Setup

Description = TypeVar("Description", bound=FileRoot)


def decode(data: dict[str, Any]) -> Result:
    """Return the result in JSON data.

    Raises:
        AttributeError, KeyError, OverflowError, TypeError, ValueError: something is missing or of another kind.
    """
    return Result(
        setup=_setup(data["setup"]),
        grasps=tuple(_grasp(grasp) for grasp in data["grasps"]),
        starts=_count(data["starts"], "starts"),
        counts={outcome: _count(count, outcome) for outcome, count in data["counts"].items()},
        verified=_count(data["verified"], "verified"),
        refuted=_count(data["refuted"], "refuted"),
        blocked={kind: Blocked(**blocked) for kind, blocked in data["blocked"].items()},
        interrupted=data["interrupted"],
        warnings=tuple(data["warnings"]),
        times=data["times"],
        provenance=_mapping(data["provenance"], "provenance"),
    )


def _mapping(data: Any, key: str) -> dict[str, Any]:
    if not isinstance(data, dict):
        raise TypeError(f"{key}: not a mapping")
    if not isinstance(data.get("sha256", {}), dict):
        raise TypeError(f"{key}.sha256: not a mapping")
    return data


def _count(data: Any, key: str) -> int:
    number = int(data)
    if not 0 <= number <= MOST:
        raise ValueError(f"{key}: {'negative' if number < 0 else 'too large'}")
    return number


def _setup(data: dict[str, Any]) -> Setup:
    robot = _described(data["robot"], RobotDescription, "robot")
    scene = _described(data["scene"], Scene, "scene")
    if data["task"] not in scene.tasks:
        raise ValueError(f"setup.task: the scene has no task {data['task']!r}")
    return Setup(robot, scene, data["task"])


def _described(data: Any, model: type[Description], name: str) -> Description:
    try:
        return model.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        raise ValueError(f"{dotted(('setup', name, *first['loc']))}: {first['msg']}") from None


def _grasp(data: dict[str, Any]) -> Grasp:
    figures = [{key: value for key, value in f.items() if key != "holds"} for f in data["certificate"]["figures"]]
    return Grasp(
        start=_count(data["start"], "start"),
        count=_count(data["count"], "count"),
        joints=_finite(data["joints"]),
        q_arm=_array(data["q_arm"]),
        synergy=_array(data["synergy"]),
        contact_parameters=_array(data["contact_parameters"]),
        internal_forces=_array(data["internal_forces"]),
        q_r=_finite(data["q_r"]),
        cost=Cost(**_finite(data["cost"])),
        contacts=tuple(_contact(contact) for contact in data["contacts"]),
        certificate=Certificate(tuple(_figure(figure) for figure in figures)),
        T_world_wrist=_array(data["T_world_wrist"], 4, 4),
    )


def _array(numbers: list[float], *shape: int) -> Array:
    return np.array(numbers, dtype=np.float64).reshape(shape or -1)


def _finite(numbers: dict[str, Any]) -> dict[str, float]:
    for name, number in numbers.items():
        if not math.isfinite(number):
            raise ValueError(f"{name} is {number}")
    return {name: float(number) for name, number in numbers.items()}


def _contact(data: dict[str, Any]) -> Contact:
    vectors = {key: _array(data[key], 3) for key in ("point", "normal", "force", "desired_point")}
    others = {"spin_torque": float(data["spin_torque"]), "T_world_pad": _array(data["T_world_pad"], 4, 4)}
    return Contact(**{**data, **vectors, **others})


def _figure(data: dict[str, Any]) -> Figure:
    # null stands for a number that was not finite: a value that proves nothing, a limit that does not judge.
    value = math.nan if data["value"] is None else float(data["value"])
    unlimited = math.inf if data["sense"] == "at most" else -math.inf
    limit = unlimited if data["limit"] is None else float(data["limit"])
    return Figure(**{**data, "value": value, "limit": limit})
