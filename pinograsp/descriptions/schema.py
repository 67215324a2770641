"""JSON Schema of robot and scene files, for editors."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel

from .robot import RobotDescription
from .scene import Scene

_MODELS: dict[str, type[BaseModel]] = {"robot": RobotDescription, "scene": Scene}


def schema(kind: Literal["robot", "scene"]) -> dict[str, Any]:
    """Return the JSON Schema of a kind of file."""
    result: dict[str, Any] = _MODELS[kind].model_json_schema()
    for internal in ("source", "digest"):  # set by the reader, never written in a file
        result["properties"].pop(internal)
        result["required"].remove(internal)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **result,
        "title": f"pinograsp {kind} file",
    }
