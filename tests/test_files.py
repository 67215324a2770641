"""Files and folders of public functions: texts and paths alike; what may not be read or written is said in words."""

from __future__ import annotations

import functools
import os
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NoReturn

import numpy as np
import pytest

import pinograsp
from pinograsp import Coverage, Database, InputError, Margins, Result, Robot, Scene, Setup
from pinograsp import cache_folder as cache_folder_module
from pinograsp.cache_folder import cache_folder, cache_folders, in_cache
from pinograsp.database import cache as cache_module
from pinograsp.database.build import build_database
from pinograsp.database.cache import cached_database
from pinograsp.database.files import create, writing
from pinograsp.database.identity import Identity
from pinograsp.disk import write_whole

Kind = Callable[[Path], str | Path]
PANDA = "package://example-robot-data/robots/panda_description/urdf/panda.urdf"
SHIPPED = pinograsp.shipped_scenes()["glovebox"]


@pytest.fixture
def database(gen3: Robot, glovebox: Scene, tmp_path: Path) -> Path:
    """A database without rows."""
    file = tmp_path / "empty.duckdb"
    facts = {"seed": 0, "spread": "joints", "layout": "unsorted", "size": 0, "versions": {}}
    create(file, Identity.of(gen3, glovebox, Margins()), facts)
    return file


@pytest.mark.parametrize("kind", [str, Path])
def test_files_are_texts_or_paths(kind: Kind, gen3: Robot, glovebox: Scene, database: Path, tmp_path: Path) -> None:
    def place(name: str) -> str | Path:
        return kind(tmp_path / name)

    assert pinograsp.load_scene(kind(SHIPPED)).name == pinograsp.load_scene(kind(Path("glovebox"))).name
    result = Result(Setup(gen3.description, glovebox, "sphere"), (), 0, {}, 0, 0, {})
    pinograsp.write_json(result, place("result.json"))
    assert pinograsp.read_json(place("result.json")).setup.task == "sphere"
    with Database.open(kind(database)) as opened:
        opened.export_parquet(place("rows.parquet"))
    counts = np.ones((2, 2, 2), dtype=np.int64)
    coverage = Coverage(np.zeros(3), 0.05, counts, counts)
    pinograsp.visualization.coverage_png(coverage, place("coverage.png"), "title")
    pinograsp.visualization.coverage_html(coverage, place("coverage.html"), "title")
    text = pinograsp.new_robot_file(PANDA, place("robot.yaml"), packages=[kind(tmp_path)]).text
    (tmp_path / "robot.yaml").write_text(text)
    assert not pinograsp.check_robot(kind(tmp_path)).wrong
    assert pinograsp.load_robot(place("robot.yaml")).arm_size == 7
    written = {"result.json", "rows.parquet", "coverage.png", "coverage.html", "robot.yaml", "empty.duckdb"}
    assert written <= {file.name for file in tmp_path.iterdir()}


@pytest.mark.parametrize(
    "name", ["gen3_2f85", Path("gen3_2f85"), "robots/gen3_2f85", Path("robots/gen3_2f85/robot.yaml")]
)
def test_shipped_robots_go_by_name(name: str | Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert pinograsp.load_robot(name).description.name == "gen3_2f85"


# ---- folders that cannot be written. A file in place of a folder refuses everybody, the administrator, too.


@pytest.fixture
def blocked(tmp_path: Path) -> Path:
    (tmp_path / "file").write_text("")
    return tmp_path / "file" / "folder"


@pytest.fixture
def builds(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Path]]:
    """The files of databases that are built from now on: without rows, in no time; no temporary cache is there yet."""
    files: list[Path] = []

    def build(robot: Robot, scene: Scene, file: Path, margins: Margins, **_: object) -> Database:
        files.append(file)
        facts = {"seed": 0, "spread": "joints", "layout": "sorted", "size": 0, "versions": {}}
        with writing(file):
            create(file, Identity.of(robot, scene, margins), facts)
        return Database.open(file)

    monkeypatch.setattr(cache_module, "build_database", build)
    made: list[TemporaryDirectory[str]] = []

    def temporary() -> TemporaryDirectory[str]:
        made.append(TemporaryDirectory(prefix="pinograsp-cache-"))
        return made[-1]

    monkeypatch.setattr(cache_folder_module, "_temporary", functools.cache(temporary))
    monkeypatch.setattr(cache_folder_module, "_warned", set())
    yield files
    for folder in made:
        folder.cleanup()


def test_a_cache_that_cannot_be_written_has_a_temporary_one_in_its_place(
    blocked: Path, gen3: Robot, glovebox: Scene, builds: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PINOGRASP_CACHE", str(blocked))
    said = f"{blocked}: the cache folder cannot be written: not a directory. Set PINOGRASP_CACHE to a folder that can"
    with pytest.warns(pinograsp.CacheWarning, match=re.escape(said)):
        first = cached_database(gen3, glovebox, Margins())
    with first, cached_database(gen3, glovebox, Margins()) as second:  # is warned of once, and built once
        assert first.file == second.file
        assert first.file.parent.name.startswith("pinograsp-cache-")
    assert len(builds) == 1
    monkeypatch.setenv("PINOGRASP_CACHE", str(blocked / "other"))

    def nowhere() -> NoReturn:
        raise FileNotFoundError(2, "No usable temporary directory found")

    monkeypatch.setattr(cache_folder_module, "_temporary", functools.cache(nowhere))
    with pytest.raises(pinograsp.UnwritableError, match="the cache folder cannot be written: not a directory") as error:
        cached_database(gen3, glovebox, Margins())
    assert error.value.file == blocked / "other"
    assert "PINOGRASP_CACHE" in (error.value.remedy or "")


def test_a_cached_database_is_shared(
    gen3: Robot, glovebox: Scene, builds: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Builders queue; who has the file open, even for writing, is in nobody's way, nor is anybody in his."""
    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path / "cache"))
    with ThreadPoolExecutor(4) as threads:
        opened = list(threads.map(lambda _: cached_database(gen3, glovebox, Margins()), range(4)))
    assert len(builds) == 1
    (file,) = (tmp_path / "cache").glob("*.duckdb")
    assert {database.file for database in opened} == {file}
    writer = f"import duckdb; c = duckdb.connect({str(file)!r}); print(c.sql('SELECT 1'), flush=True); input()"
    command = [sys.executable, "-c", writer]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout is not None
        assert other.stdout.readline()  # it has the file, while four others are open here
        opened.append(cached_database(gen3, glovebox, Margins()))
        other.communicate("\n")
    assert other.returncode == 0
    for database in opened:
        assert database.metadata()["layout"] == "sorted"
        database.close()


@contextmanager
def nearly_full(most: int) -> Iterator[None]:
    """Let no file grow beyond so many bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_full_disk_is_said_and_nothing_is_left(gen3: Robot, glovebox: Scene, database: Path, tmp_path: Path) -> None:
    folder = tmp_path / "full"
    identity = Identity.of(gen3, glovebox, Margins())

    def created() -> None:
        with writing(folder / "rows.duckdb"):
            create(folder / "rows.duckdb", identity, {})

    with Database.open(database) as opened:
        for write in (
            lambda: write_whole(folder / "text", "x" * 10_000),
            lambda: opened.export_parquet(folder / "rows.parquet"),
            created,
        ):
            with nearly_full(100), pytest.raises(pinograsp.UnwritableError, match="cannot be written: file too large"):
                write()
    assert list(folder.iterdir()) == []


@pytest.mark.usefixtures("builds")
def test_no_home_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("PINOGRASP_CACHE")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", unknown)
    with pytest.raises(pinograsp.UnwritableError, match=r"no home folder for the cache\. Set PINOGRASP_CACHE"):
        cache_folder()
    with pytest.warns(pinograsp.CacheWarning, match=r"no home folder for the cache\. Set PINOGRASP_CACHE"):
        written = in_cache(lambda folder: folder / "file")
    assert written in [folder / "file" for folder in cache_folders()]
    monkeypatch.setenv("XDG_CACHE_HOME", "/somewhere")
    assert cache_folder() == Path("/somewhere/pinograsp")


def test_databases_are_not_written(blocked: Path, database: Path, gen3: Robot, glovebox: Scene) -> None:
    with pytest.raises(InputError, match=r"rows\.duckdb: cannot be written: not a directory"):
        build_database(gen3, glovebox, blocked / "rows.duckdb", size=10, workers=1)
    with Database.open(database) as opened, pytest.raises(InputError, match=r"rows\.parquet: cannot be written"):
        opened.export_parquet(blocked / "rows.parquet")


def test_a_folder_that_may_not_be_looked_into(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(path: Path) -> bool:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "is_file", refused)
    with pytest.raises(InputError, match="no such scene file"):
        pinograsp.load_scene("/closed/scene.yaml")
    with pytest.raises(InputError, match="no such robot file"):
        pinograsp.load_robot("/closed/robot.yaml")
    with pytest.raises(InputError, match="no such database"):
        Database.open("/closed/rows.duckdb")


def as_anybody(*command: str | Path) -> list[str]:
    """Return the command as a user without the administrator's rights to files would run it."""
    if os.geteuid() == 0:
        if shutil.which("setpriv") is None:
            pytest.skip("needs setpriv, or another user than root")
        drop = ["setpriv", "--bounding-set=-dac_override,-dac_read_search,-fowner", "--inh-caps=-all"]
        return [*drop, *map(str, command)]
    return [str(part) for part in command]


DENIED = """
import sys
from pathlib import Path
import numpy as np
import pinograsp
closed, counts = Path(sys.argv[1]), np.ones((2, 2, 2), dtype=int)
coverage = pinograsp.Coverage(np.zeros(3), 0.05, counts, counts)
for call in (
    lambda: pinograsp.load_scene(closed / "scene.yaml"),
    lambda: pinograsp.read_json(closed / "scene.yaml"),
    lambda: pinograsp.Database.open(closed / "rows.duckdb"),
    lambda: pinograsp.visualization.coverage_html(coverage, closed / "page.html", ""),
    lambda: pinograsp.visualization.coverage_png(coverage, closed / "new" / "page.png", ""),
):
    try:
        call()
        print("done")
    except pinograsp.InputError as error:
        print(error.problem)
"""


@pytest.mark.parametrize("place", ["folder", "file"])
def test_permission_denied(place: str, database: Path, tmp_path: Path) -> None:
    """In words, wherever it happens: no traceback."""
    closed = tmp_path / "closed"
    closed.mkdir()
    shutil.copy(database, closed / "rows.duckdb")
    shutil.copy(SHIPPED, closed / "scene.yaml")
    if place == "folder":
        closed.chmod(0o000)
    else:
        for file in closed.iterdir():
            file.chmod(0o000)
        closed.chmod(0o500)
    try:
        done = subprocess.run(
            as_anybody(sys.executable, "-c", DENIED, closed), capture_output=True, text=True, check=False, timeout=120
        )
    finally:
        closed.chmod(0o700)
    assert done.returncode == 0, done.stderr
    missing = place == "folder"
    scene, result, rows, *pictures = done.stdout.splitlines()
    assert scene.startswith("no such scene file") if missing else scene == "cannot be read: permission denied"
    assert result == "cannot be read: permission denied"
    assert rows == ("no such database" if missing else "cannot be opened: permission denied")
    assert pictures == 2 * ["cannot be written: permission denied"]
