"""A result as JSON data.

Lengths in metres, angles in radians, forces in newtons, world frame, except where a key says otherwise (phi_mm2).
Numbers that are not finite are null. `digest` is the SHA-256 of everything else in the file.
"""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

from ..descriptions.model import FileRoot
from ..disk import digest
from .grasp import Contact, Grasp
from .result import Result
from .setup import Setup

FORMAT_VERSION = 3


def encode(result: Result) -> dict[str, Any]:
    """Return a result as JSON data, its digest included."""
    content = _finite(_content(result))
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return {"format_version": FORMAT_VERSION, "digest": digest(canonical.encode()), **content}


def encode_grasp(grasp: Grasp) -> dict[str, Any]:
    """Return a grasp as JSON data, without its setup."""
    data: dict[str, Any] = _finite(
        {
            "start": grasp.start,
            "count": grasp.count,
            "joints": grasp.joints,
            "q_arm": grasp.q_arm.tolist(),
            "synergy": grasp.synergy.tolist(),
            "contact_parameters": grasp.contact_parameters.tolist(),
            "internal_forces": grasp.internal_forces.tolist(),
            "q_r": grasp.q_r,
            "cost": dataclasses.asdict(grasp.cost),
            "contacts": [_contact(contact) for contact in grasp.contacts],
            "certificate": grasp.certificate.to_json(),
            "T_world_wrist": grasp.T_world_wrist.tolist(),
        }
    )
    return data


def _content(result: Result) -> dict[str, Any]:
    return {
        "format_version": FORMAT_VERSION,
        "setup": _setup(result.setup),
        "interrupted": result.interrupted,
        "warnings": list(result.warnings),
        "starts": result.starts,
        "counts": result.counts,
        "verified": result.verified,
        "refuted": result.refuted,
        "blocked": {kind: dataclasses.asdict(blocked) for kind, blocked in result.blocked.items()},
        "times_s": result.times,
        "provenance": result.provenance,
        "grasps": [encode_grasp(grasp) for grasp in result.grasps],
    }


def _setup(setup: Setup) -> dict[str, Any]:
    return {"robot": _file(setup.robot), "scene": _file(setup.scene), "task": setup.task}


def _file(description: FileRoot) -> dict[str, Any]:
    """Return the content of a robot file or scene file; where it was read from holds in every working directory."""
    source = None if description.source is None else str(description.source.resolve())
    return description.model_dump(mode="json") | {"source": source}


def _contact(contact: Contact) -> dict[str, Any]:
    return {
        "pad": contact.pad,
        "link": contact.link,
        "point": contact.point.tolist(),
        "normal": contact.normal.tolist(),
        "force": contact.force.tolist(),
        "spin_torque": contact.spin_torque,
        "desired_point": contact.desired_point.tolist(),
    }


def _finite(data: Any) -> Any:
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_finite(value) for value in data]
    return data
