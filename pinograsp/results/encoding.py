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
    content["grasps"] = content.pop("grasps")  # behind what is shorter
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return {"format_version": FORMAT_VERSION, "digest": digest(canonical.encode()), **content}
