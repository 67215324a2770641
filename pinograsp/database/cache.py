"""Small databases in the user's cache folder, for plans that are given none."""

from __future__ import annotations

import tempfile
from pathlib import Path

from ..descriptions import Scene
from ..descriptions.task import Margins
from ..disk import cache_folder, is_file, reason_of
from ..errors import FileError, InputError
from ..kinematics.robot import Robot
from ..progress import Report, no_report
from .build import build_database
from .identity import Identity
from .store import Database, require_identity

SIZE = 100_000
"""Configurations in a cached database."""
SEED = 0


def cached_database(
    robot: Robot,
    scene: Scene,
    margins: Margins,
    *,
    workers: int | None = None,
    progress: Report = no_report,
) -> Database:
    """Return the small database of a robot, enclosure and margins; built on first use.

    Raises:
        InputError: the cached file is damaged; the message names it, so that it can be deleted. Or it is not there, and
            the cache folder cannot be written.
    """
    identity = Identity.of(robot, scene, margins)
    file = cache_folder() / f"{robot.description.name}-{identity.digest[:16]}.duckdb"
    there = _complete(file, identity)
    if there is not None:
        return there
    _require_writable(file.parent)
    return build_database(
        robot, scene, file, size=SIZE, seed=SEED, margins=margins, workers=workers, wait=True, progress=progress
    )


def _require_writable(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        problem = f"the cache folder cannot be written: {reason_of(error)}"
        remedy = "Set PINOGRASP_CACHE to a folder that can, or give a database"
        raise FileError(problem, file=folder, remedy=remedy) from None


def _complete(file: Path, identity: Identity) -> Database | None:
    """Return the database of a file, or None if it is not there or not complete."""
    if not is_file(file):
        return None
    database = Database.open(file)
    try:
        require_identity(database, identity)
        complete = database.metadata()["layout"] == "sorted"
    except InputError:
        database.close()
        raise
    if complete:
        return database
    database.close()
    return None
