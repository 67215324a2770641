"""The start database: what it holds, that it survives being killed, and what it refuses."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import duckdb
import numpy as np
import pytest
from conftest import collision_model

import pinograsp
from pinograsp.cli import main
from pinograsp.cli.database_query import configurations_table
from pinograsp.collision.batch_clearance import BatchClearance
from pinograsp.collision.scene_world import enclosure_world
from pinograsp.collision.world import CLEARANCES
from pinograsp.database import build, sampling
from pinograsp.database import cache as cache_module
from pinograsp.database.build import build_database
from pinograsp.database.cache import cached_database
from pinograsp.database.coverage import Coverage
from pinograsp.database.layout import exported
from pinograsp.database.lock import building
from pinograsp.database.query import Configurations, configurations_near, spread_configurations
from pinograsp.database.sampling import DRAWS
from pinograsp.database.store import Database, interruptible
from pinograsp.descriptions.enclosure import Enclosure
from pinograsp.descriptions.task import Margins
from pinograsp.errors import InputError
from pinograsp.frozen import json_data
from pinograsp.geometry.cone import DirectionCone
from pinograsp.kinematics.forward import forward
from pinograsp.kinematics.hand_posture import hand_opening
from pinograsp.progress import Progress
from pinograsp.verification.check import Verifier

SIZE = 9_000
"""Two batches."""
BUILD = """
import sys, pinograsp
pinograsp.build_database(
    pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox"), sys.argv[1], size=int(sys.argv[2]), workers=2
)
"""

OBJECT = CLEARANCES["target"]


def everything(file: Path) -> dict[str, Any]:
    """All rows of a database in the order of the file."""
    with Database.open(file) as database:
        return dict(database.connection.execute("SELECT * FROM configurations").fetchnumpy())


def same(first: dict[str, Any], second: dict[str, Any]) -> bool:
    return first.keys() == second.keys() and all(np.array_equal(first[name], second[name]) for name in first)


@pytest.fixture(scope="module")
def small(gen3: Any, glovebox: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("database") / "box.duckdb"
    build_database(gen3, glovebox, file, size=SIZE, workers=1).close()
    return file


def test_rows_do_not_depend_on_workers_or_growth(small: Path, gen3: Any, glovebox: Any, tmp_path: Path) -> None:
    grown = tmp_path / "grown.duckdb"
    with build_database(gen3, glovebox, grown, size=100, workers=2) as first:
        assert 100 <= first.rows() < SIZE
    with build_database(gen3, glovebox, grown, size=SIZE, workers=2) as second:
        assert second.info()["layout"] == "sorted"
    assert same(everything(small), everything(grown))
    with build_database(gen3, glovebox, grown, size=10, workers=2) as third:
        assert third.rows() >= SIZE  # a smaller size takes nothing away


def test_another_seed_gives_other_rows(small: Path, gen3: Any, glovebox: Any, tmp_path: Path) -> None:
    build_database(gen3, glovebox, tmp_path / "other.duckdb", size=100, seed=1, workers=1).close()
    ours, others = (everything(file) for file in (small, tmp_path / "other.duckdb"))
    rows = [set(zip(*(table[f"q{i}"] for i in range(1, 8)), strict=True)) for table in (ours, others)]
    assert len(rows[1]) > 1000
    assert not rows[0] & rows[1]


@pytest.mark.parametrize(("size", "batches"), [(100, 1), (1000, 1), (2000, 2)])
def test_few_rows_take_few_batches(
    size: int, batches: int, gen3: Any, glovebox: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of batches of 16,384 samples, of which some 1,150 are free."""
    for module in (build, sampling):
        monkeypatch.setattr(module, "DRAWS", 16_384)
    drawn, draw = [], sampling.BatchSampler.__call__

    def counted(self: sampling.BatchSampler, number: int) -> sampling.Batch:
        drawn.append(number)
        return draw(self, number)

    monkeypatch.setattr(sampling.BatchSampler, "__call__", counted)
    with build_database(gen3, glovebox, tmp_path / "few.duckdb", size=size, workers=1) as database:
        assert database.rows() >= size
    assert drawn == list(range(batches))


def test_killed_at_any_moment_and_resumed_gives_the_same_rows(gen3: Any, glovebox: Any, tmp_path: Path) -> None:
    size = 30_000
    whole, killed = tmp_path / "whole.duckdb", tmp_path / "killed.duckdb"
    build_database(gen3, glovebox, whole, size=size, workers=2).close()
    seen = []
    for wanted in (1, 3, 5):
        process = subprocess.Popen([sys.executable, "-c", BUILD, str(killed), str(size)], start_new_session=True)
        deadline = time.monotonic() + 60
        while process.poll() is None and time.monotonic() < deadline and batches_in(killed) < wanted:
            time.sleep(0.02)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        with Database.open(killed) as database:  # opens, and holds whole batches
            listed = database.connection.execute("SELECT coalesce(sum(accepted), 0) FROM batches").fetchall()[0][0]
            assert database.rows() == listed
            seen.append(database.rows())
    assert seen[-1] > 0
    build_database(gen3, glovebox, killed, size=size, workers=2, wait=True).close()
    assert same(everything(whole), everything(killed))


def batches_in(file: Path) -> int:
    """How many batches the log or the file of a running build is likely to hold, by their size on disk."""
    log = file.with_name(file.name + ".wal")
    return sum(path.stat().st_size for path in (file, log) if path.exists()) // 300_000


def test_rows_are_what_pinocchio_and_coal_say(small: Path, gen3: Any, glovebox: Any) -> None:
    import pinocchio as pin

    robot = gen3.mounted(glovebox.mounting.matrix)
    model = collision_model(robot, glovebox, "sphere")
    model._reach[:] = 0.1  # measures all that is told apart in the rows
    data, hand = robot.model.createData(), hand_opening(robot)
    rows = everything(small)
    for index in np.random.default_rng(0).choice(len(rows["q1"]), 60, replace=False):
        posture = np.concatenate([[float(rows[f"q{i}"][index]) for i in range(1, 8)], hand])
        configuration = forward(robot, data, posture)
        pin.updateFramePlacements(robot.model, data)
        wrist = data.oMf[robot.wrist_frame]
        assert [rows[name][index] for name in "xyz"] == pytest.approx(wrist.translation, abs=1e-6)
        assert [rows[name][index] for name in ("ax", "ay", "az")] == pytest.approx(wrist.rotation[:, 2], abs=1e-6)
        measured = model.distances(configuration)
        kinds = [model.pairs[pair].kind for pair in measured.indices]
        least = min([value for value, kind in zip(measured.values, kinds, strict=True) if kind != OBJECT] + [0.05])
        assert rows["clearance"][index] == pytest.approx(least, abs=1e-6)
        assert least >= 0.005


def test_no_row_collides_by_the_independent_check(small: Path, gen3: Any, glovebox: Any) -> None:
    verifier, hand, rows = Verifier(gen3.description, glovebox, "sphere"), hand_opening(gen3), everything(small)
    for index in np.random.default_rng(1).choice(len(rows["q1"]), 200, replace=False):
        posture = np.concatenate([[float(rows[f"q{i}"][index]) for i in range(1, 8)], hand])
        certificate = verifier.check_posture(gen3.joints_by_name(posture))
        assert certificate.verified, certificate.refuted_by


def test_rejected_samples_do_collide(small: Path, gen3: Any, glovebox: Any) -> None:
    """The cheap tests reject nothing that Coal would accept."""
    robot = gen3.mounted(glovebox.mounting.matrix)
    model = collision_model(robot, glovebox, "sphere")
    data, hand = robot.model.createData(), hand_opening(robot)
    low = np.maximum(robot.lower[:7], -np.pi)
    high = np.minimum(robot.upper[:7], np.pi)
    q = np.random.default_rng(3).uniform(low, high, (400, 7))
    kept, _, _ = BatchClearance(robot, enclosure_world(robot, glovebox, Margins()), hand).measure(q)
    assert 5 < len(kept) < 200
    for index in range(len(q)):
        measured = model.distances(forward(robot, data, np.concatenate([q[index], hand])))
        kinds = [model.pairs[pair].kind for pair in measured.indices]
        free = all(value >= 0.005 for value, kind in zip(measured.values, kinds, strict=True) if kind != OBJECT)
        assert free == (index in kept)


def test_rows_lie_along_the_curve(small: Path) -> None:
    rows = everything(small)
    order = np.lexsort((rows["sample"], rows["cell"]))
    assert np.array_equal(order, np.arange(len(order)))
    assert len(np.unique(rows["sample"])) == len(rows["sample"])
    assert rows["sample"].max() < 2 * DRAWS
    first, last = rows["cell"] < 2**29, rows["cell"] >= 2**29  # the first bit of the curve halves z
    assert rows["z"][first].max() <= rows["z"][last].min()


@pytest.mark.parametrize("extent", [0.25, np.array([0.2, 0.1, 0.3])], ids=["ball", "box"])
@pytest.mark.parametrize("cone", [None, DirectionCone(np.array([0.0, 0.0, -2.0]), 0.8)], ids=["all", "cone"])
@pytest.mark.parametrize("joints", [{}, {"joint_2": [(-1.0, 1.2)], "joint_7": [(-4.0, -1.0), (0.0, 2.5)]}], ids=len)
def test_region_is_what_a_filter_of_all_rows_gives(
    small: Path, extent: Any, cone: DirectionCone | None, joints: Any
) -> None:
    center, rows = np.array([0.6, 0.0, 0.0]), everything(small)
    apart = np.column_stack([rows[name] for name in "xyz"]).astype(float) - center
    inside = (np.abs(apart) <= extent).all(axis=1) if np.ndim(extent) else np.linalg.norm(apart, axis=1) <= extent
    if cone is not None:
        inside &= -rows["az"].astype(float) >= np.cos(0.8)
    for name, intervals in joints.items():
        angles = rows[name.replace("joint_", "q")]
        inside &= np.any([(angles >= low) & (angles <= high) for low, high in intervals], axis=0)
    with Database.open(small) as database:
        found = configurations_near(database, center, extent, cone=cone, joints=joints)
        chosen = spread_configurations(database, center, extent, 20, cone=cone, joints=joints)
        again = spread_configurations(database, center, extent, 20, cone=cone, joints=joints)
        other = spread_configurations(database, center, extent, 20, cone=cone, joints=joints, seed=5)
        everyone = spread_configurations(database, center, extent, 10**5, cone=cone, joints=joints)
    assert inside.sum() > 40
    assert set(found.samples) == set(rows["sample"][inside]) == set(everyone.samples)
    assert len(chosen) == len(set(chosen.samples)) == 20
    assert set(chosen.samples) <= set(found.samples)
    assert np.array_equal(chosen.samples, again.samples)
    assert set(other.samples) != set(chosen.samples)


def test_selection_spreads(small: Path) -> None:
    """Neighbours on the curve are near each other; a spread selection is not."""
    center = np.array([0.6, 0.0, 0.0])
    with Database.open(small) as database:
        near = configurations_near(database, center, 0.3, limit=100)
        spread = spread_configurations(database, center, 0.3, 100)
    assert np.prod(spread.positions.std(axis=0)) > 2 * np.prod(near.positions.std(axis=0))
    assert (spread.approaches.std(axis=0) > 0.35).all()


def test_even_wrists(gen3: Any, glovebox: Any, small: Path, tmp_path: Path) -> None:
    def unevenness(database: Database) -> float:
        counts = Coverage.of(database, voxel=0.15).counts
        reached = counts[counts > 20]
        return float(reached.std() / reached.mean())

    with Database.open(small) as database:
        uneven = unevenness(database)
    with build_database(gen3, glovebox, tmp_path / "even.duckdb", size=4000, spread="wrist", workers=2) as database:
        assert database.info()["spread"] == "wrist"
        assert unevenness(database) < 0.75 * uneven
    with pytest.raises(InputError, match="made with spread 'wrist', not 'joints'"):
        build_database(gen3, glovebox, tmp_path / "even.duckdb", size=4000)


def test_coverage_counts_every_row(small: Path, glovebox: Any) -> None:
    rows = everything(small)
    with Database.open(small) as database:
        coverage = Coverage.of(database, voxel=0.1)
        assert coverage == Coverage.of(database, voxel=0.1) != Coverage.of(database, voxel=0.2)
    for array in (coverage.origin, coverage.counts, coverage.directions):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    assert coverage.counts.shape == (11, 9, 6)
    assert coverage.rows == coverage.counts.sum() == len(rows["q1"])
    assert coverage.voxels == 11 * 9 * 6
    assert coverage.mean_directions == pytest.approx(coverage.directions.sum() / (coverage.counts > 0).sum())
    assert ((coverage.directions > 0) == (coverage.counts > 0)).all()
    assert coverage.directions.max() <= 24
    assert (coverage.directions <= coverage.counts).all()
    fullest = np.array(np.unravel_index(coverage.counts.argmax(), coverage.counts.shape))
    low = coverage.origin + 0.1 * fullest
    places = np.column_stack([rows[name] for name in "xyz"])
    inside = ((places >= low) & (places < low + 0.1)).all(axis=1)
    assert inside.sum() == pytest.approx(coverage.counts.max(), abs=2)  # float32 at the faces


def test_a_region_may_be_as_large_as_numbers_are(small: Path) -> None:
    with Database.open(small) as database:
        for extent in (1e308, [1e308, 1e200, 1e10]):
            assert len(configurations_near(database, [0.8, 0.0, -0.1], extent)) == database.rows()
            assert len(configurations_near(database, [-1e308, 0.0, 0.0], 1.0)) == 0


def test_an_export_takes_the_place_of_no_other_file(small: Path, tmp_path: Path) -> None:
    """Not of the database itself, however it is called; of an earlier export it does."""
    link, notes, content = tmp_path / "link.parquet", tmp_path / "mine.yaml", small.read_bytes()
    link.symlink_to(small)
    notes.write_text("mine: 1")
    with Database.open(small) as database:
        for place, words in (
            (small, "no Parquet file"),
            (link, "no Parquet file"),
            (notes, "no Parquet file"),
            (tmp_path, "is a folder"),
        ):
            with pytest.raises(pinograsp.FileError, match=words):
                database.export_parquet(place)
        for _ in range(2):
            database.export_parquet(tmp_path / "rows.parquet")
    assert small.read_bytes() == content
    assert notes.read_text() == "mine: 1"


def test_parquet_has_the_joints_by_name(small: Path, tmp_path: Path) -> None:
    with Database.open(small) as database:
        database.export_parquet(tmp_path / "it's.parquet")
        count = database.rows()
    quoted = str(tmp_path / "it's.parquet").replace("'", "''")
    relation = duckdb.sql(f"SELECT * FROM '{quoted}'")
    assert {"joint_1", "joint_7", "x", "az", "clearance", "sample"} <= set(relation.columns)
    assert len(relation.fetchnumpy()["joint_1"]) == count


# ---- refusals


def test_two_joints_of_one_name_are_damage(small: Path, tmp_path: Path) -> None:
    file = tmp_path / "twice.duckdb"
    file.write_bytes(small.read_bytes())
    change = "UPDATE metadata SET value = replace(value, '\"joint_5\"', '\"joint_3\"') WHERE key = 'identity'"
    with duckdb.connect(str(file)) as connection:
        connection.execute(change)
    with pytest.raises(pinograsp.FileError, match=r"identity.robot.joints: .* two joints have the same name"):
        Database.open(file)


def test_no_two_columns_of_an_export_have_one_name() -> None:
    others = ["x", "y", "z", "ax", "ay", "az", "clearance", "cell", "sample"]
    assert exported(["shoulder", "elbow"]) == ["shoulder", "elbow", *others]
    assert exported(["x", "Y", "lift", "LIFT"]) == ["q1", "q2", "lift", "q4", *others]
    assert exported(["q2", "x", "X"]) == ["q2", "q2_", "q3", *others]


@pytest.mark.parametrize(
    ("part", "key"), [("margins", "robot"), ("enclosure", "walls"), ("robot", "lower")], ids=lambda value: value
)
def test_database_of_something_else_is_refused(
    part: str, key: str, small: Path, gen3: Any, glovebox: Any, tmp_path: Path
) -> None:
    margins, robot, scene = Margins(), gen3, glovebox
    if part == "margins":
        margins = Margins(enclosure=0.005, robot=0.002)
    elif part == "enclosure":
        walls = Enclosure(min=glovebox.enclosure.min, max=(1.2, 0.42, 0.363))
        scene = glovebox.model_copy(update={"enclosure": walls})
    else:
        arm = gen3.description.arm.model_copy(update={"limits": {"joint_2": (-1.0, 1.0)}})
        robot = pinograsp.Robot(gen3.description.model_copy(update={"arm": arm}))
    before = small.read_bytes()
    with pytest.raises(InputError) as caught:
        build_database(robot, scene, small, size=10**6, margins=margins)
    message = str(caught.value)
    assert message.startswith(f"{small}: was made for another {part} (")
    assert "in the database" in message
    assert "wanted; the hash of" in message
    assert key in message
    assert small.read_bytes() == before


def test_plan_refuses_a_database_of_other_margins(gen3: Any, glovebox: Any, tmp_path: Path) -> None:
    file = tmp_path / "tight.duckdb"
    build_database(gen3, glovebox, file, size=10, margins=Margins(enclosure=0.001, robot=0.001), workers=1).close()
    with pytest.raises(InputError, match="was made for another margins"):
        pinograsp.plan(gen3, glovebox, "sphere", starts=4, workers=1, database=file)


def test_foreign_and_damaged_files_are_left_alone(small: Path, gen3: Any, glovebox: Any, tmp_path: Path) -> None:
    text, foreign, cut = tmp_path / "text.duckdb", tmp_path / "foreign.duckdb", tmp_path / "cut.duckdb"
    text.write_text("not a database " * 1000)
    with duckdb.connect(str(foreign)) as connection:
        connection.execute("CREATE TABLE configurations (x FLOAT)")
    cut.write_bytes(small.read_bytes()[:3000])
    other = tmp_path / "joints.json"  # which DuckDB opens
    other.write_text('{"joint_1": 0.5}\n')
    for file, words in (
        (other, "damaged or not a DuckDB file"),
        (text, "damaged or not"),
        (foreign, "not a pinograsp start database"),
        (cut, "damaged"),
    ):
        before = file.read_bytes()
        with pytest.raises(InputError, match=words):
            build_database(gen3, glovebox, file, size=10)
        with pytest.raises(InputError, match=words):
            Database.open(file)
        assert file.read_bytes() == before
    with pytest.raises(InputError, match="no such database"):
        Database.open(tmp_path / "missing.duckdb")


def test_a_database_that_is_open_here(small: Path, gen3: Any, glovebox: Any) -> None:
    with (
        Database.open(small),
        pytest.raises(pinograsp.FileError, match=r"open in this process for reading. Close it first"),
    ):
        build_database(gen3, glovebox, small, size=10**6)
    with (
        Database.open(small, read_only=False),
        pytest.raises(pinograsp.FileError, match=r"open in this process for writing. Close it first"),
    ):
        Database.open(small)


def test_what_is_complete_is_not_built_and_others_may_read_it(small: Path, gen3: Any, glovebox: Any) -> None:
    reading = "import duckdb, sys; c = duckdb.connect(sys.argv[1], read_only=True); print('open', flush=True); input()"
    reader = subprocess.Popen(
        [sys.executable, "-c", reading, str(small)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert reader.stdin is not None and reader.stdout is not None
    try:
        assert reader.stdout.readline() == "open\n"
        before = small.stat().st_mtime_ns
        with build_database(gen3, glovebox, small, size=SIZE, wait=True) as database:
            assert database.rows() >= SIZE
        assert small.stat().st_mtime_ns == before
        with pytest.raises(pinograsp.FileError, match="in use by another process"):
            build_database(gen3, glovebox, small, size=10**6)
    finally:
        reader.communicate("\n")


def test_one_builder_at_a_time(small: Path, gen3: Any, glovebox: Any) -> None:
    with (
        building(small, wait=False),
        pytest.raises(InputError, match="is being built by another process"),
    ):
        build_database(gen3, glovebox, small, size=10**6)


def test_hopeless_enclosure(gen3: Any, glovebox: Any, tmp_path: Path) -> None:
    coffin = Enclosure(min=(0.0, -0.05, -0.05), max=(1.5, 0.05, 0.05))
    scene = glovebox.model_copy(update={"enclosure": coffin})
    with build_database(gen3, scene, tmp_path / "none.duckdb", size=10, workers=2) as database:
        facts = database.info()
    assert (facts["rows"], facts["samples_drawn"], facts["layout"]) == (0, 8 * DRAWS, "unsorted")
    result = pinograsp.plan(gen3, scene_with_room_for_the_sphere(scene), "sphere", starts=4, workers=1)
    assert (result.done, result.best) == (0, None)


def scene_with_room_for_the_sphere(scene: Any) -> Any:
    """Return the scene with its sphere inside the enclosure."""
    sphere = scene.objects["sphere"]
    moved = sphere.model_copy(update={"pose": sphere.pose.model_copy(update={"position": (0.8, 0.0, 0.0)})})
    return scene.model_copy(update={"objects": {"sphere": moved}})


# ---- cache and command line


def test_cached_database_is_built_once(
    gen3: Any, glovebox: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path))
    monkeypatch.setattr(cache_module, "SIZE", 3000)
    reports: list[Progress] = []
    with cached_database(gen3, glovebox, Margins(), workers=1, progress=reports.append) as database:
        file, rows = database.file, database.rows()
    of_build = [report for report in reports if report.stage == "start database"]
    assert [report.done for report in of_build] == sorted({report.done for report in of_build})
    assert of_build[-1].done == of_build[-1].total >= rows
    assert reports[-1] == Progress("sorting", 0, rows)
    assert of_build[0] == Progress("start database", 0, 3000)  # before anything is waited for
    assert all(report.numbers["rows per second"] > 0.0 for report in of_build[1:])
    assert file.parent == tmp_path
    changed = file.stat().st_mtime_ns
    reports.clear()
    with cached_database(gen3, glovebox, Margins(), workers=1, progress=reports.append) as database:
        assert (database.file, database.rows()) == (file, rows)
    assert not reports
    assert file.stat().st_mtime_ns == changed


def test_command_line(
    small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(*words: str) -> str:
        monkeypatch.setattr(sys, "argv", ["pinograsp", "database", *words])
        with pytest.raises(SystemExit) as stopped:
            main()
        assert stopped.value.code == 0
        return capsys.readouterr().out

    file = tmp_path / "cli.duckdb"
    margins = ("--margin", "0.01", "--robot-margin", "0.002")
    assert "configurations in" in run("build", str(file), "--scene", "glovebox", "--size", "1e3", *margins, "--wait")
    facts = json.loads(run("info", str(file), "--json"))
    assert facts["margins"] == {"enclosure": 0.01, "robot": 0.002}
    assert f"rows: {facts['rows']:,}\n" in run("info", str(file))
    assert facts["rows"] >= 1000
    assert facts["joints"] == [f"joint_{i}" for i in range(1, 8)]
    center = ("--center", "0.6", "0.0", "0.0")
    assert "5 configurations" in run("query", str(file), *center, "--radius", "0.3", "--count", "5")
    cone = ("--cone", "0", "0", "-1", "--angle", "40")
    assert "3 configurations" in run("query", str(file), *center, "--radius", "0.4", "--count", "3", *cone)
    box = ("--box", "0.4", "0.3", "0.2", "--joint", "joint_1=-2,-1", "--joint", "joint_1=1,2", "--seed", "5")
    within: dict[str, Any] = {"joints": {"joint_1": [(-2.0, -1.0), (1.0, 2.0)]}}
    with Database.open(file) as opened:
        half = np.array([0.4, 0.3, 0.2])
        spread = spread_configurations(opened, np.array([0.6, 0.0, 0.0]), half, 4, seed=5, **within)
        near = configurations_near(opened, np.array([0.6, 0.0, 0.0]), half, limit=4, **within)
    for found, options in ((spread, ()), (near, ("--no-spread",))):
        assert len(found) == 4
        assert json.loads(run("query", str(file), *center, *box, "--count", "4", *options, "--json")) == found.to_json()
    rows = json.loads(run("query", str(file), *center, "--radius", "0.4", "--count", "3", *cone, "--json"))
    assert rows["joints"] == facts["joints"]
    assert np.shape(rows["q"]) == (3, 7)
    assert (np.linalg.norm(np.array(rows["positions"]) - [0.6, 0.0, 0.0], axis=1) <= 0.4).all()
    parquet = str(tmp_path / "rows.parquet")
    assert f"written: {parquet}\n" in run("export", str(file), parquet)
    assert f"replaced: {parquet}\n" in run("export", str(file), parquet)
    covered = run("coverage", str(file), "--voxel", "0.1", "--png", "--out", str(tmp_path))
    assert "the wrist reaches" in covered
    assert f"written: {tmp_path / 'cli_coverage.png'}\n" in covered
    assert (tmp_path / "cli_coverage.png").stat().st_size > 10_000
    with Database.open(file) as opened:
        covering = Coverage.of(opened, 0.1)
    for name, value in json.loads(run("coverage", str(file), "--voxel", "0.1", "--json")).items():
        assert json_data(getattr(covering, name)) == value


@pytest.mark.parametrize("width", [80, 60])
def test_table_of_configurations_fits(width: int) -> None:
    found = Configurations(
        tuple(f"joint_{i}" for i in range(1, 10)),
        np.full((2, 9), -math.pi),
        np.full((2, 3), -9.999),
        np.full((2, 3), -1.0),
        np.full(2, 0.05),
        np.arange(2),
    )
    lines = configurations_table(found, width).drawn(width).splitlines()
    assert max(map(len, lines)) <= width
    text = "\n".join(lines)
    assert (text.count(" -180"), text.count("-9999"), text.count(" 50 ")) == (18, 6, 2)


def test_ctrl_c_in_a_statement() -> None:
    with pytest.raises(RuntimeError, match="another"), interruptible():
        raise RuntimeError("another")
    for raised in (duckdb.InterruptException, RuntimeError("Query interrupted")):
        with pytest.raises(KeyboardInterrupt), interruptible():
            raise raised


@pytest.mark.parametrize("threads", [1, 4])
@pytest.mark.parametrize("select", [Database.select, Database.select_columns])
def test_ctrl_c_in_a_query_of_a_database(select: Callable[[Database, str], object], threads: int) -> None:
    """Of every database: plans, coverages and selections ask through these two. The query would take hours."""
    query = "SELECT sum(sqrt(a.range * b.range)) FROM range(1_000_000) AS a, range(1_000_000) AS b"
    with Database(Path(), duckdb.connect(config={"threads": threads})) as database:
        threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            select(database, query)
        assert database.select("SELECT 2")[0] == (2,)
