"""The content of a result file.

It is the result by its attributes (`Record.to_json`): lengths in metres, angles in radians, forces in newtons, world
frame, except where a key says otherwise (phi_mm2). Numbers that are not finite are null. Besides it has the
`format_version`, and the `digest`, the SHA-256 of everything else in the file.
"""

from __future__ import annotations

import json
from typing import Any

from ..disk import digest
from .result import Result

FORMAT_VERSION = 4


def encode(result: Result) -> dict[str, Any]:
    """Return the content of a result's file, its digest included."""
    content = {"format_version": FORMAT_VERSION, **result.to_json()}
    if result.explanation is None:  # files with grasps are as they were before there were explanations
        del content["explanation"]
    content["grasps"] = content.pop("grasps")  # behind what is shorter
    return _sealed(content)


def encode_as(result: Result, data: dict[str, Any]) -> dict[str, Any]:
    """Return the content of a result's file, of robot and scene only the keys that a file has that holds the result.

    Robot and scene files get keys with time, and what was written before has them not.

    Args:
        result: that was read.
        data: the content of the file that it was read from.
    """
    content = {key: part for key, part in encode(result).items() if key != "digest"}
    return _sealed(content | {"setup": _keys_of(data["setup"], content["setup"])})


def _keys_of(given: Any, whole: Any) -> Any:
    if isinstance(given, dict) and isinstance(whole, dict):
        return {key: _keys_of(given[key], part) for key, part in whole.items() if key in given}
    if isinstance(given, list) and isinstance(whole, list) and len(given) == len(whole):
        return [_keys_of(*parts) for parts in zip(given, whole, strict=True)]
    return whole


def _sealed(content: dict[str, Any]) -> dict[str, Any]:
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return {"format_version": FORMAT_VERSION, "digest": digest(canonical.encode()), **content}
