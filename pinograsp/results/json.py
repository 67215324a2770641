"""Results as JSON.

The layout has a format version; `read_json` refuses others. Lengths in metres, angles in radians, forces in
newtons, world frame, except where a key says otherwise (phi_mm2). Numbers that are not finite are null.
"""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from ..disk import write_whole
from ..errors import InputError
from ..verification.certificate import Certificate, Figure
from .grasp import Blocked, Contact, Cost, Grasp, Result

FORMAT_VERSION = 1


def write_json(result: Result, file: Path) -> None:
    """Write a result; the file is there whole or not at all."""
    text = json.dumps(_finite(_result(result)), indent=1, allow_nan=False)
    write_whole(file, text + "\n")


def read_json(file: Path) -> Result:
    """Read a result that `write_json` wrote.

    Raises:
        InputError: the file is missing, is no JSON, or is of another format.
    """
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"cannot be read: {(error.strerror or str(error)).lower()}", file=file) from None
    except ValueError as error:
        raise InputError(f"is not valid JSON: {error}", file=file) from None
    version = data.get("format_version") if isinstance(data, dict) else None
    if version != FORMAT_VERSION:
        raise InputError(
            f"format version {version} cannot be read; this pinograsp reads {FORMAT_VERSION}",
            file=file,
            key="format_version",
        )
    try:
        return _read_result(data)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"is damaged: {type(error).__name__} {error}", file=file) from None


def _result(result: Result) -> dict[str, Any]:
    return {
        "format_version": FORMAT_VERSION,
        "robot": result.robot,
        "scene": result.scene,
        "task": result.task,
        "interrupted": result.interrupted,
        "warnings": list(result.warnings),
        "starts": result.starts,
        "counts": result.counts,
        "reliable": result.reliable,
        "refuted": result.refuted,
        "blocked": {kind: dataclasses.asdict(blocked) for kind, blocked in result.blocked.items()},
        "times_s": result.times,
        "provenance": result.provenance,
        "grasps": [_grasp(grasp) for grasp in result.grasps],
    }


def _grasp(grasp: Grasp) -> dict[str, Any]:
    return {
        "start": grasp.start,
        "count": grasp.count,
        "joints": grasp.joints,
        "q_arm": grasp.q_arm.tolist(),
        "synergy": grasp.synergy.tolist(),
        "contact_parameters": grasp.contact_parameters.tolist(),
        "internal_forces": grasp.internal_forces.tolist(),
        "q_r": grasp.q_r,
        "cost": {"U": grasp.cost.U, "phi_mm2": grasp.cost.phi_mm2, "V": grasp.cost.V},
        "contacts": [
            {
                "pad": contact.pad,
                "link": contact.link,
                "point": contact.point.tolist(),
                "normal": contact.normal.tolist(),
                "force": contact.force.tolist(),
                "spin_torque": contact.spin_torque,
                "desired_point": contact.desired_point.tolist(),
            }
            for contact in grasp.contacts
        ],
        "certificate": grasp.certificate.to_json(),
    }


def _finite(data: Any) -> Any:
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_finite(value) for value in data]
    return data


def _read_result(data: dict[str, Any]) -> Result:
    return Result(
        robot=data["robot"],
        scene=data["scene"],
        task=data["task"],
        grasps=tuple(_read_grasp(grasp) for grasp in data["grasps"]),
        starts=data["starts"],
        counts=data["counts"],
        reliable=data["reliable"],
        refuted=data["refuted"],
        blocked={kind: Blocked(**blocked) for kind, blocked in data["blocked"].items()},
        interrupted=data["interrupted"],
        warnings=tuple(data.get("warnings", ())),
        times=data["times_s"],
        provenance=data["provenance"],
    )


def _read_grasp(data: dict[str, Any]) -> Grasp:
    figures = [{key: value for key, value in f.items() if key != "holds"} for f in data["certificate"]["figures"]]
    return Grasp(
        start=data["start"],
        count=data["count"],
        joints=data["joints"],
        q_arm=np.array(data["q_arm"]),
        synergy=np.array(data["synergy"]),
        contact_parameters=np.array(data["contact_parameters"]),
        internal_forces=np.array(data["internal_forces"]),
        q_r=data["q_r"],
        cost=Cost(**data["cost"]),
        contacts=tuple(_read_contact(contact) for contact in data["contacts"]),
        certificate=Certificate(tuple(_read_figure(figure) for figure in figures)),
    )


def _read_contact(data: dict[str, Any]) -> Contact:
    fields: dict[str, Any] = {key: np.array(value) if isinstance(value, list) else value for key, value in data.items()}
    return Contact(**fields)


def _read_figure(data: dict[str, Any]) -> Figure:
    # null stands for a number that was not finite: a value that proves nothing, a limit that does not judge.
    value = math.nan if data["value"] is None else data["value"]
    unlimited = math.inf if data["sense"] == "at most" else -math.inf
    limit = unlimited if data["limit"] is None else data["limit"]
    return Figure(**{**data, "value": value, "limit": limit})
