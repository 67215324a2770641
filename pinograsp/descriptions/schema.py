"""JSON Schema of robot and scene files, for editors."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core.core_schema import ModelSchema

from ..errors import UnknownNameError, close_names
from .docstrings import field_docstrings
from .problems import INTERNAL
from .robot import RobotDescription
from .scene import Scene

_MODELS: dict[str, type[BaseModel]] = {"robot": RobotDescription, "scene": Scene}


def schema(kind: Literal["robot", "scene"]) -> dict[str, Any]:
    """Return the JSON Schema of a kind of file; editors show what it says of each key."""
    if not isinstance(kind, str) or kind not in _MODELS:
        remedy = close_names(kind, _MODELS)
        raise UnknownNameError(f"there are no files of kind {kind!r}", key="kind", remedy=remedy)
    result: dict[str, Any] = _MODELS[kind].model_json_schema(schema_generator=_Described)
    for internal in INTERNAL:  # set by the reader, never written in a file
        result["properties"].pop(internal)
    for block in (result, *result["$defs"].values()):
        _require(block)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **result,
        "title": f"pinograsp {kind} file",
    }


class _Described(GenerateJsonSchema):
    """Describes keys by the strings below the fields; pydantic's own way reads the source whenever it is imported."""

    def model_schema(self, schema: ModelSchema) -> JsonSchemaValue:
        block = super().model_schema(schema)
        for name, text in field_docstrings(schema["cls"]).items():
            if name in block["properties"]:
                block["properties"][name]["description"] = text
        return block


def _require(block: dict[str, Any]) -> None:
    """Have files give the format and the tags by which blocks are told apart, though in Python the class says them."""
    properties = block.get("properties", {})
    tags = [name for name, value in properties.items() if "const" in value]
    for name in tags:
        properties[name].pop("default", None)
    if required := {*tags, *block.get("required", [])}:
        block["required"] = [name for name in properties if name in required]
