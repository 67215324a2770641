"""The keys of robot and scene files as tables, from their JSON Schema."""

from __future__ import annotations

import json
from typing import Any

from pinograsp.descriptions.schema import schema

Block = dict[str, Any]
_FIRST = {"format", "name", "description"}
_NUMBERS = {"number": "number", "integer": "whole number"}
_BOUNDS = {"exclusiveMinimum": ">", "gt": ">", "minimum": ">=", "ge": ">=", "exclusiveMaximum": "<", "lt": "<"}
_BOUNDS |= {"maximum": "<=", "le": "<="}


def schema_keys(kind: str) -> str:
    """Return a section with a table for the file and for every kind of block in it, as Markdown."""
    if kind not in ("robot", "scene"):
        raise ValueError(f"there is no schema of {kind} files")
    whole = schema("robot") if kind == "robot" else schema("scene")
    blocks: dict[str, Block] = whole["$defs"]
    parts = [f"## The whole {kind} file {{ #{kind} }}", _table(whole, blocks)]
    for name in _in_order(whole, blocks):
        table = _table(blocks[name], blocks)
        parts += [f"## {name} {{ #{_anchor(name)} }}", _described(blocks[name]), table]
    return "\n\n".join(parts)


def _in_order(whole: Block, blocks: dict[str, Block]) -> list[str]:
    """Return the names of the blocks, each after the one in which it is met first."""
    found: list[str] = []

    def visit(block: Block) -> None:
        for name in _references(block):
            if name not in found:
                found.append(name)
                visit(blocks[name])

    visit({key: value for key, value in whole.items() if key != "$defs"})
    return found


def _references(part: Any) -> list[str]:
    if isinstance(part, dict):
        own = [part["$ref"].rpartition("/")[2]] if "$ref" in part else []
        return own + [name for value in part.values() for name in _references(value)]
    return [name for value in part for name in _references(value)] if isinstance(part, list) else []


def _described(block: Block) -> str:
    return " ".join(block.get("description", "").split("\n\n")[0].split())


def _table(block: Block, blocks: dict[str, Block]) -> str:
    rows = ["| key | value | default | meaning |", "|---|---|---|---|"]
    keys = sorted(block.get("properties", {}), key=lambda key: key not in _FIRST)
    for key, value in ((key, block["properties"][key]) for key in keys):
        default = "required" if key in block.get("required", []) else _default(value)
        inner = _references(value)
        meaning = value.get("description") or (_described(blocks[inner[0]]) if len(inner) == 1 else "")
        cells = (f"`{key}`", _value(value), default, meaning.replace("|", "\\|"))
        rows.append("| " + " | ".join(cells) + " |")
    return '<div class="keys" markdown>\n\n' + "\n".join(rows) + "\n\n</div>"


def _default(value: Block) -> str:
    default = value.get("default")
    return "" if isinstance(default, dict) or default in (None, "", []) else f"`{json.dumps(default)}`"


def _value(value: Block) -> str:
    if "$ref" in value:
        name = value["$ref"].rpartition("/")[2]
        return f"[{name}](#{_anchor(name)})"
    for several in ("anyOf", "oneOf"):
        if several in value:
            return " or ".join(_value(one) for one in value[several] if one.get("type") != "null")
    if "const" in value:
        return f"`{value['const']}`"
    if "enum" in value:
        return " or ".join(f"`{one}`" for one in value["enum"])
    return _typed(value)


def _typed(value: Block) -> str:
    kind = value.get("type")
    if kind in _NUMBERS:
        bounds = ", ".join(f"{sign} {value[key]:.4g}" for key, sign in _BOUNDS.items() if key in value)
        return f"{_NUMBERS[kind]} {bounds}".strip()
    if kind == "array" and "prefixItems" in value:
        items = {_value(item) for item in value["prefixItems"]}
        return f"list of {len(value['prefixItems'])}: {' or '.join(sorted(items))}"
    if kind == "array":
        least = f", at least {value['minItems']}" if value.get("minItems", 0) > 1 else ""
        return f"list{least}: {_value(value.get('items', {}))}"
    if kind == "object":
        return f"by name: {_value(value.get('additionalProperties', {}))}"
    return {"string": "text", "boolean": "`true` or `false`"}.get(str(kind), "")


def _anchor(name: str) -> str:
    return name.lower()
