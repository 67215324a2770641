"""The model of a grasp as a file that MuJoCo's viewer opens."""

from __future__ import annotations

from pathlib import Path

from ..disk import as_path, write_whole
from ..errors import require_kind
from ..results import Grasp
from .mjcf import HandAndObject
from .options import HoldOptions, given_options


def write_mjcf(grasp: Grasp, file: Path | str, options: HoldOptions | None = None) -> None:
    """Write the model of a grasp as one file, meshes and drive in it; MuJoCo is not needed for that.

    `python -m mujoco.viewer --mjcf=FILE` opens it: the hand holds the object against gravity.

    Args:
        grasp: of a result.
        file: to be written.
        options: control and friction.

    Raises:
        InputError: as `hold_test`; or the file cannot be written.
    """
    require_kind("grasp", grasp, Grasp)
    bodies = HandAndObject(grasp.required_setup, given_options(options))
    write_whole(as_path("file", file), bodies.model(grasp, shown=True).xml + "\n")
