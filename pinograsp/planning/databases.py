"""The start databases of a session: found or built, certain to be the right ones, and kept open."""

from __future__ import annotations

from pathlib import Path

from ..database.cache import cached_database
from ..database.identity import Identity
from ..database.store import Database, identity_of, require_identity
from ..descriptions import Scene
from ..descriptions.task import Margins
from ..errors import InputError
from ..kinematics.robot import Robot
from ..memo import remembered
from ..progress import Report
from ..solve.start_index import StartIndex


class Databases:
    """Where the starts of a robot come from.

    Args:
        robot: what is planned for.
        given: the one database, or its file; None: small ones in the user's cache folder, built on first use.
        workers: number of processes that build one; None: one for each core.
        report: called as one is built.
    """

    def __init__(self, robot: Robot, given: Database | Path | str | None, workers: int | None, report: Report) -> None:
        self._robot, self._given, self._workers, self._report = robot, given, workers, report
        self._opened: dict[str, Database] = {}

    def of(self, scene: Scene, margins: Margins) -> Database:
        """Return the database for a scene and margins; what is opened here stays open until `close`.

        Raises:
            DatabaseMismatchError: the one that was given is of another robot, enclosure or margin.
            InputError: it cannot be opened, or none can be built.
        """
        identity = Identity.of(self._robot, scene, margins)
        if isinstance(self._given, Database):
            require_identity(self._given, identity)
            return self._given
        if identity.digest not in self._opened:
            if self._given is None:
                opened = cached_database(self._robot, scene, margins, workers=self._workers, progress=self._report)
            else:
                opened = Database.open(self._given)
            try:
                require_identity(opened, identity)
            except InputError:
                opened.close()
                raise
            self._opened[identity.digest] = opened
        return self._opened[identity.digest]

    def widest(self, scene: Scene, margins: Margins) -> Database:
        """Return the database for a scene with margins that are smaller or the same: those that are usual, at most.

        From it changes of the margins can be tried, too. It is the one that was given if there is one. Errors as of
        `of`.
        """
        if self._given is None:
            usual = Margins()
            margins = margins.model_copy(
                update={name: min(value, getattr(usual, name)) for name, value in margins.fields().items()}
            )
        return self.of(scene, margins)

    def index(self, scene: Scene, margins: Margins) -> StartIndex:
        """Return the starts in memory: for every scene with one enclosure the same. Errors as of `of`."""
        indices, database = _indices(self._robot.unmounted), self.of(scene, margins)
        stat = database.file.stat()
        key = (identity_of(database).digest, str(database.file.resolve()), stat.st_mtime_ns, stat.st_size)
        if key not in indices:
            indices[key] = StartIndex(database, self._robot.mounted(scene.mounting.matrix))
        return indices[key]

    def close(self) -> None:
        """Close what was opened here."""
        for database in self._opened.values():
            database.close()
        self._opened.clear()


@remembered
def _indices(robot: Robot) -> dict[tuple[str, str, int, int], StartIndex]:
    """Return the place where the indices of a robot are kept, by identity and file of their database, as it is now."""
    del robot
    return {}
