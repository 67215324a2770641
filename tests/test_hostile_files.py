"""Files that are damaged, foreign or made to harm: refused in words, in little time and memory, or made anew."""

from __future__ import annotations

import faulthandler
import fcntl
import importlib.util
import json
import os
import random
import shutil
import signal
import sys
import time
import warnings
from collections import Counter
from pathlib import Path
from types import ModuleType
from typing import Any

import duckdb
import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import fuzz_kinds
import fuzz_run
import fuzz_supervisor
import pinograsp
from fuzz_mutations import NUMBERS, OTHERS, TEXTS
from fuzz_toy import random_robot
from pinograsp import DamagedError, Database, FileError, InputError, Margins, Pose, Result, Robot, Scene
from pinograsp import compiled as compiled_module
from pinograsp.array_cache import kept
from pinograsp.compiled import compiling
from pinograsp.database import cache as cache_module
from pinograsp.database.cache import cached_database
from pinograsp.disk import content_of, write_whole
from pinograsp.errors import UnwritableError
from pinograsp.problem.angle_findings import angle_findings
from pinograsp.progress import Progress
from pinograsp.results.typed import read

# ---- YAML and JSON that say more than memory holds.

ALIASES = "a0: &a0 [x,x,x,x,x,x,x,x,x,x]\n"
BOMB = ALIASES + "".join(f"a{i}: &a{i} [{','.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 9))
MERGED = "a0: &a0 {k: 1}\n" + "".join(f"a{i}: &a{i} {{<<: [{','.join([f'*a{i - 1}'] * 10)}]}}\n" for i in range(1, 9))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (BOMB, "aliases repeat more than 100000 values"),
        (MERGED, "aliases repeat more than 100000 values"),
        ("a: &a [*a]\n", "a part contains itself"),
        ("[" * 5000, "not valid YAML"),
        ("format: " + "9" * 5000, "a number of 5000 digits cannot be meant"),
        ("format: 0x" + "f" * 5000, "a number of 5002 digits cannot be meant"),
        ("name: " + "x" * 2**20, "has more than 1 048 576 bytes"),
    ],
    ids=["bomb", "merged bomb", "circle", "nested", "long number", "long hexadecimal number", "large"],
)
def test_a_scene_that_says_too_much_is_refused(text: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(text)
    with pytest.raises(FileError, match=words) as caught:
        pinograsp.load_scene(file)
    assert caught.value.file == file
    assert len(str(caught.value)) < 1000


def test_aliases_that_repeat_little_are_read(glovebox: Scene, tmp_path: Path) -> None:
    text = Path(glovebox.source or "").read_text()
    (tmp_path / "scene.yaml").write_text(text.replace("sphere:\n    shape", "sphere: &ball\n    shape", 1) + "\n")
    assert pinograsp.load_scene(tmp_path / "scene.yaml") == glovebox


def test_json_that_is_nested_without_end_is_refused(tmp_path: Path) -> None:
    for depth, words in ((65, "more than 64 levels are nested"), (100_000, "not valid JSON")):
        (tmp_path / "result.json").write_text('{"format_version": 4, "a": ' + "[" * depth + "]" * depth + "}")
        with pytest.raises(FileError, match=words):
            pinograsp.read_json(tmp_path / "result.json")


def test_a_file_without_end_is_not_read_to_its_end() -> None:
    with pytest.raises(FileError, match="has more than 10 000 bytes"):
        content_of(Path("/dev/zero"), 10_000)


JSON = st.recursive(
    st.one_of(st.sampled_from([*NUMBERS, *TEXTS, *OTHERS]), st.none(), st.booleans(), st.floats(), st.text()),
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(st.text(max_size=5), inner, max_size=5),
    max_leaves=20,
)


@given(kind=st.sampled_from([*Result.__annotations__]), data=JSON)
def test_any_json_is_read_by_its_type_or_refused(kind: str, data: Any) -> None:
    """Whatever stands in place of a field of a result."""
    with pytest.raises(InputError):
        read(Result, {kind: data})


# ---- Extremes in scenes.


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (("contact", "kappa"), 1e-300, "a number of 1e-09 or more is wanted"),
        (("contact", "friction"), 5e-324, "a number of 1e-09 or more is wanted"),
        (("contact", "max_force"), 1e308, "a number between -1e+09 and 1e+09 is wanted"),
        (("start_radius",), 1e-12, "a number of 1e-09 or more is wanted"),
    ],
)
def test_extreme_numbers_are_refused_with_their_key(
    path: tuple[str, ...], value: float, words: str, glovebox: Scene
) -> None:
    data = glovebox.to_dict()
    block = data["tasks"]["sphere"]
    for key in path[:-1]:
        block = block[key]
    block[path[-1]] = value
    with pytest.raises(InputError) as caught:
        Scene.from_dict(data)
    assert caught.value.key == "tasks.sphere." + ".".join(path)
    assert words in str(caught.value)


@pytest.mark.parametrize(("name", "words"), [("a\0b", "U\\+0000 is not allowed"), ("x" * 300, "300 bytes .* too long")])
def test_names_that_no_file_can_have_are_refused(name: str, words: str, glovebox: Scene) -> None:
    with pytest.raises(InputError, match=words):
        glovebox.model_copy(update={"name": name})


def test_degrees_that_are_given_for_radians_get_a_remark(glovebox: Scene, gen3: Robot) -> None:
    assert angle_findings(glovebox, gen3.description) == []
    turned = glovebox.model_copy(update={"mounting": Pose(rpy=(0.0, 90.0, 0.0))})
    (remark,) = angle_findings(turned, gen3.description)
    assert remark.startswith("mounting.rpy has an angle of 90 rad, more than a turn")
    assert remark.endswith("90 degrees are 1.5708")
    there = glovebox.with_object_pose("sphere", Pose(position=(0.8, 0.0, -0.19), rpy=(-45.0, 6.29, 0.0)))
    (remark,) = angle_findings(there)
    assert remark.startswith("objects.sphere.pose.rpy has an angle of -45 rad")


# ---- Databases.


@pytest.fixture(scope="module")
def small(gen3: Robot, glovebox: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("database") / "small.duckdb"
    pinograsp.build_database(gen3, glovebox, file, size=500, workers=1).close()
    return file


def changed(small: Path, folder: Path, *statements: str) -> Path:
    file = Path(shutil.copy(small, folder / "changed.duckdb"))
    with duckdb.connect(str(file)) as connection:
        for statement in statements:
            connection.execute(statement)
    return file


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("DROP TABLE batches", "other tables or columns than those of a pinograsp start database: batches"),
        ("DROP TABLE metadata", "is a DuckDB file, but not a pinograsp start database"),
        ("ALTER TABLE configurations DROP COLUMN q3", ": configurations"),
        ("ALTER TABLE configurations ALTER q3 TYPE VARCHAR", ": configurations"),
        ("ALTER TABLE batches ALTER drawn SET DEFAULT 7", ": batches"),
        ("CREATE VIEW more AS SELECT * FROM read_text('/etc/hostname')", ": more"),
        ("CREATE MACRO isfinite(a) AS true", ": isfinite"),
        ("DELETE FROM metadata WHERE key = 'identity'", "identity: is damaged: metadata: this key is missing"),
        ("UPDATE metadata SET value = NULL", "its metadata are no JSON"),
        ("UPDATE metadata SET value = '[' WHERE key = 'seed'", "its metadata are no JSON"),
        ("UPDATE metadata SET value = '\"x\"' WHERE key = 'seed'", "seed: is damaged"),
        ("UPDATE metadata SET value = '{}' WHERE key = 'identity'", "identity.robot: is damaged"),
        ("UPDATE metadata SET value = replace(value, '\"joints\": [', '\"joints\": [7, ')", "joints[0]: is damaged"),
    ],
)
def test_a_database_of_another_layout_is_refused(statement: str, words: str, small: Path, tmp_path: Path) -> None:
    file = changed(small, tmp_path, statement)
    before = file.read_bytes()
    for read_only in (True, False):
        with pytest.raises(DamagedError) as caught:
            Database.open(file, read_only=read_only)
        assert words in str(caught.value)
        assert caught.value.file == file
    assert file.read_bytes() == before


@pytest.mark.parametrize("value", ["NULL", "'nan'", "'-inf'"])
def test_rows_that_are_no_numbers_are_refused(value: str, small: Path, tmp_path: Path) -> None:
    file = changed(small, tmp_path, f"UPDATE configurations SET y = {value} WHERE sample % 50 = 0")
    with Database.open(file) as database:
        with pytest.raises(DamagedError, match="missing or not finite"):
            database.require_sound()
        with pytest.raises(DamagedError, match="missing or not finite"):
            database.select_columns("SELECT y FROM configurations")
        with pytest.raises(DamagedError, match="missing or not finite"):
            database.export_parquet(tmp_path / "out.parquet")
    assert not (tmp_path / "out.parquet").exists()


def test_names_of_joints_are_no_sql(small: Path, tmp_path: Path) -> None:
    name = "a\", (SELECT content FROM read_text('/etc/hostname')) AS \"b"
    with duckdb.connect(str(small), read_only=True) as connection:
        [(text,)] = connection.execute("SELECT value FROM metadata WHERE key = 'identity'").fetchall()
    identity = json.loads(text)
    identity["robot"]["joints"][0] = name
    written = json.dumps(identity).replace("'", "''")
    file = changed(small, tmp_path, f"UPDATE metadata SET value = '{written}' WHERE key = 'identity'")
    out = tmp_path / "it's.parquet"
    with Database.open(file) as database:
        assert database.joints()[0] == name
        database.export_parquet(out)
    with duckdb.connect() as connection:
        assert connection.read_parquet(str(out)).columns[:2] == [name, "joint_2"]


def test_nothing_in_an_open_database_reads_another_file(small: Path) -> None:
    with Database.open(small) as database, pytest.raises(duckdb.PermissionException):
        database.connection.execute("SELECT * FROM read_text('/etc/hostname')")


def test_a_damaged_cached_database_is_made_anew(
    small: Path, gen3: Robot, glovebox: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built: list[Path] = []

    def build(robot: Robot, scene: Scene, file: Path, **_: Any) -> Database:
        """Do what building does, quickly: go on with what is there, or make it."""
        built.append(file)
        return Database.open(file if file.exists() else shutil.copy(small, file))

    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path))
    monkeypatch.setattr(cache_module, "build_database", build)

    def rows() -> Any:
        with cached_database(gen3, glovebox, Margins(), workers=1) as database:
            return database.select("SELECT * FROM configurations ORDER BY sample")

    first = rows()
    (file,) = tmp_path.glob("[!.]*.duckdb")
    whole = file.read_bytes()
    middle = len(whole) // 2
    flipped = whole[: 3 * 4096] + bytes(byte ^ 255 for byte in whole[3 * 4096 :])  # all but the headers
    for damaged in (b"", b"text", whole[:middle], flipped):
        file.write_bytes(damaged)
        assert rows() == first
    changed(file, tmp_path, "UPDATE configurations SET q1 = 'nan'").replace(file)
    assert rows() == first
    assert len(built) == 6
    changed(file, tmp_path, "DROP TABLE batches").replace(file.with_name(f".{file.name}.unfinished"))
    file.unlink()
    assert rows() == first
    assert len(built) == 8  # what was begun is damaged, too
    assert rows() == first
    assert len(built) == 8


def test_a_folder_in_place_of_a_database_is_built_anew(
    small: Path, gen3: Robot, glovebox: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def build(robot: Robot, scene: Scene, file: Path, **_: Any) -> Database:
        return Database.open(shutil.copy(small, file))

    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path))
    monkeypatch.setattr(cache_module, "build_database", build)
    cached_database(gen3, glovebox, Margins(), workers=1).close()
    (file,) = tmp_path.glob("[!.]*.duckdb")
    for folder in (file, file.with_name(f".{file.name}.unfinished")):
        folder.unlink(missing_ok=True)
        folder.mkdir()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cached_database(gen3, glovebox, Margins(), workers=1).close()
    assert file.is_file()


@pytest.mark.parametrize(
    ("keys", "named"),
    [({"srdf": "a\0b"}, "srdf"), ({"urdf": "package://x/a\0b"}, "urdf"), ({"packages": ["x=a\0b"]}, r"packages\[0\]")],
)
def test_texts_with_nul_characters_are_refused(keys: dict[str, Any], named: str, tmp_path: Path) -> None:
    urdf, robot = random_robot(random.Random(0))
    (tmp_path / "toy.urdf").write_text(urdf)
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(robot | keys))
    with pytest.raises(InputError, match=rf"{named}.*character U\+0000"):
        pinograsp.load_robot(tmp_path / "robot.yaml")


# ---- Compiled functions.

SOURCE = """
from pinograsp.compiled import compiled

@compiled
def double(x):
    return 2.0 * x
"""


def module_of(file: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("damaged_module", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
def test_damaged_machine_code_is_compiled_anew(suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    (tmp_path / "damaged_module.py").write_text(SOURCE)

    def compilations() -> int:
        seen: list[Progress] = []
        with compiling(seen.append):
            assert module_of(tmp_path / "damaged_module.py").double(3.0) == 6.0
        return len(seen)

    assert compilations() > 0
    assert compilations() == 0
    (file,) = (tmp_path / "__pycache__").glob(f"*.{suffix}")
    whole = file.read_bytes()
    middle = len(whole) // 2
    for damaged in (b"", whole[:middle], whole[:middle] + b"\xff" + whole[middle + 1 :], whole[:-32]):
        file.write_bytes(damaged)
        assert compilations() > 0
        assert compilations() == 0


@pytest.mark.parametrize("failing", [".nbi", ".nbc"])
def test_a_full_disk_costs_compiled_functions_their_file_alone(
    failing: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(file: Path, content: bytes) -> None:
        if file.suffix == failing:
            raise UnwritableError("cannot be written: no space left on device", file=file)
        write_whole(file, content)

    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.setattr(compiled_module, "write_whole", full)
    (tmp_path / "damaged_module.py").write_text(SOURCE)
    for _ in range(2):
        assert module_of(tmp_path / "damaged_module.py").double(3.0) == 6.0
    assert not list((tmp_path / "__pycache__").glob(f"*{failing}"))


def test_a_folder_in_place_of_a_cached_file_is_that_file_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path))
    (tmp_path / "some" / "arrays.npz" / "inner").mkdir(parents=True)

    def get(made: float) -> float:
        return kept(
            "some", "arrays", lambda: made, lambda value: {"a": np.array(value)}, lambda found: float(found["a"])
        )

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert get(1.0) == 1.0
    assert get(2.0) == 1.0


def test_what_a_killed_process_left_is_removed(tmp_path: Path) -> None:
    left, writing, other = (tmp_path / name for name in (".a.txt.killed", ".a.txt.writing", ".a.txt.mine"))
    for folder in (left, writing, other):
        folder.mkdir()
        (folder / "a.txt").write_text("half")
    (other / "b.txt").write_text("not written here")
    for folder in (left, writing, other):
        os.utime(folder, (0.0, 0.0))
    handle = os.open(writing, os.O_RDONLY)
    fcntl.flock(handle, fcntl.LOCK_EX)
    write_whole(tmp_path / "a.txt", "whole")
    os.close(handle)
    assert sorted(tmp_path.iterdir()) == sorted([writing, other, tmp_path / "a.txt"])


def test_a_compound_in_a_compound_is_refused_in_words(glovebox: Scene) -> None:
    inner = {"type": "compound", "radius": 0.03}
    content = glovebox.to_dict()
    content["objects"]["sphere"]["shape"] = {"type": "compound", "parts": [{"shape": inner}]}
    with pytest.raises(InputError, match="unknown key"):
        Scene.from_dict(content)


def test_a_source_with_a_null_is_refused() -> None:
    with pytest.raises(InputError, match=r"U\+0000"):
        pinograsp.load_robot("gen3_2f85").description.model_copy(update={"source": Path("a\0b")})


# ---- Everything at random.


def test_an_input_that_hangs_or_grows_is_killed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fuzz_supervisor, "SECONDS", 3.0)
    monkeypatch.setattr(fuzz_supervisor, "STILL", 9.0)
    monkeypatch.setattr(fuzz_supervisor, "MEMORY", 2**27)

    def work(numbers: range, pipe: int) -> None:
        for number in numbers:
            os.write(pipe, f"{number} begun\n".encode())
            if number == 1:
                while True:
                    pass
            elif number == 2:
                time.sleep(1e6)
            elif number == 3:
                kept = [np.ones(2**26)]
                time.sleep(1e6 * len(kept))
            elif number == 4:
                faulthandler.disable()  # it is on purpose
                os.kill(os.getpid(), signal.SIGSEGV)
            os.write(pipe, f"{number} used\n".encode())

    found = dict(fuzz_supervisor.supervised(work, range(6), tmp_path / "log"))
    assert found == {0: "used", 1: "time", 2: "time", 3: "memory", 4: "SIGSEGV", 5: "used"}


def test_whatever_is_read_is_refused_in_words_or_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A few of the inputs of `tools/fuzz.py`; robots, results and databases need sources, which the slow run makes."""
    found: Counter[str] = Counter()
    fuzz_kinds.warm(tmp_path)
    for kind in ("scene", "cache"):
        home = tmp_path / kind
        home.mkdir()
        monkeypatch.setenv("PINOGRASP_CACHE", str(home / "cache"))
        for _, outcome in fuzz_run.run(kind, 0, range(100), home):
            found[outcome] += 1
    assert found.keys() == {"used", "refused"}, found
    assert found.total() == 200


@pytest.mark.slow
def test_200_000_inputs(tmp_path: Path) -> None:
    found = fuzz_run.fuzz(list(fuzz_kinds.KINDS), 200_000, 0, tmp_path)
    assert sum(counts.total() for counts in found.values()) >= 200_000
    assert {outcome for counts in found.values() for outcome in counts} <= {"used", "refused"}, fuzz_run.table(found)
