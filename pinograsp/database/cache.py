"""Small databases in the user's cache folder, for plans that are given none.

Any number of processes share them. One builds at a time, in a file beside, and the others wait; under its name a
database is complete. Plans read copies of their own: so nobody who has the file open, be it for writing, is in the way
of a plan, nor a plan in anybody's.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from ..cache_folder import cache_folders, in_cache
from ..descriptions import Scene
from ..descriptions.task import Margins
from ..disk import is_file, make_way
from ..errors import DamagedError, DatabaseMismatchError, FileError
from ..kinematics.robot import Robot
from ..progress import Progress, Report, no_report
from .build import build_database
from .identity import Identity
from .lock import building
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
    """Return the small database of a robot, enclosure and margins; built on first use, and anew where it is damaged.

    Raises:
        InputError: it is not there, and neither the cache folder nor a temporary one can be written.
    """
    identity = Identity.of(robot, scene, margins)
    name = f"{robot.description.name}-{identity.digest[:16]}.duckdb"

    def build(file: Path) -> Database:
        return build_database(
            robot, scene, file, size=SIZE, seed=SEED, margins=margins, workers=workers, wait=True, progress=progress
        )

    def built(folder: Path) -> Database:
        file, unfinished = folder / name, folder / f".{name}.unfinished"
        progress(Progress("start database", 0, SIZE))  # before it waits for who builds it already
        with building(file, wait=True):
            if (there := _there(file, identity)) is not None:  # another process has built it meanwhile
                return there
            make_way(file)
            make_way(unfinished)
            try:
                build(unfinished).close()
            except (DamagedError, DatabaseMismatchError):  # what was begun cannot be gone on with
                unfinished.unlink()
                build(unfinished).close()
            unfinished.replace(file)
        return _copied(file)

    for folder in cache_folders():
        if (there := _there(folder / name, identity)) is not None:
            return there
    return in_cache(built)


def _there(file: Path, identity: Identity) -> Database | None:
    """Return the database of a file, or None if it is not there, damaged, or not complete: of an older version."""
    if not is_file(file):
        return None
    try:
        database = _copied(file)
    except DamagedError:
        return None
    try:
        database.require_sound()
        require_identity(database, identity)
        if database.metadata()["layout"] == "sorted" or not database.rows():
            return database
    except (DamagedError, DatabaseMismatchError):
        pass
    database.close()
    return None


def _copied(file: Path) -> Database:
    """Open a copy, which is gone when it is closed; where there is no room for one, the file itself."""
    try:
        with tempfile.TemporaryDirectory() as folder:  # the system keeps the content while it is open
            copy = shutil.copyfile(file, Path(folder) / file.name)
            return Database(file, Database.open(copy).connection)
    except OSError:
        return Database.open(file)
    except FileError as error:
        raise type(error)(error.problem, file=file, remedy=error.remedy) from None
