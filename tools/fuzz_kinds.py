"""The kinds of files that pinograsp reads: how a damaged one is made, and what a user does with it.

A kind is an entry of `KINDS`: `make` writes the files of an input to a folder, `use` reads them as a user would and
goes on with what was read. Whatever comes of that must be a `PinograspError`, or right.
"""

from __future__ import annotations

import contextlib
import copy
import json
import math
import random
import shutil
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import duckdb
import numpy as np
import yaml

import pinograsp
from fuzz_mutations import mutate_bytes, mutate_tree, mutate_xml
from fuzz_sources import SOURCES, content_of, random_scene, shipped, sources
from fuzz_toy import random_robot
from pinograsp.array_cache import kept
from pinograsp.cache_folder import cache_folders
from pinograsp.database.query import configurations_near, spread_configurations
from pinograsp.database.store import Database
from pinograsp.descriptions import shipped_robots, shipped_scenes
from pinograsp.geometry.shapes import surface_of
from pinograsp.problem.checks import check_placement
from pinograsp.results.encoding import encode
from pinograsp.results.table import grasp_table, outcome_lines

SHIPPED = 0.1
"""Share of the URDFs and SRDFs that are shipped ones: they take longer than the toy."""
RAW = 0.15
"""Share of the inputs whose bytes are changed, not their structure."""


FIELDS = 30
"""Of so many meshes, one has its distance field made, which takes most of a second."""


class SilentNaNError(Exception):
    """A number that is not finite where nothing says so."""


@dataclass(frozen=True)
class Kind:
    """One kind of files."""

    make: Callable[[Path, random.Random], None]
    """Writes an input to an empty folder."""
    use: Callable[[Path], None]
    """Does with the input in a folder what a user does."""
    command: Callable[[Path], list[str]] | None = None
    """Arguments of a command that reads it."""
    share: int = 20
    """Of all inputs, as against the others: few of what takes long."""


def warm(folder: Path) -> None:
    """Use sound inputs, so that libraries are loaded and functions compiled before time counts; opens no database."""
    for number in range(20):
        rng = random.Random(number)
        (folder / "scene.yaml").write_text(yaml.safe_dump(random_scene(rng)))
        with contextlib.suppress(pinograsp.PinograspError):  # bodies may lie in each other
            use_scene(folder)
    urdf, tree = random_robot(random.Random(0))
    (folder / "toy.urdf").write_text(urdf)
    (folder / "robot.yaml").write_text(yaml.safe_dump(tree))
    use_robot(folder)
    for source in sources(Path(SOURCES[0]))["mesh"] if SOURCES else ():
        shutil.copy(source, folder / f"body{source.suffix}")
        (folder / "scene.yaml").write_text(yaml.safe_dump(_with_mesh(random_scene(rng), f"body{source.suffix}", "m")))
        use_mesh(folder)
    for source in sources(Path(SOURCES[0]))["result"] if SOURCES else ():
        shutil.copy(source, folder / "result.json")
        use_result(folder)


def _written(file: Path, tree: Any, rng: random.Random) -> None:
    """Write a mutated tree; of some only the bytes are changed, or the tree says things twice."""
    if rng.random() >= RAW:
        mutate_tree(tree, rng)
    text = _json(tree) if file.suffix == ".json" else yaml.dump(tree, sort_keys=False, allow_unicode=True)
    data = text.encode("utf-8", "surrogatepass")
    file.write_bytes(mutate_bytes(data, rng) if rng.random() < RAW else data)


def _json(tree: Any) -> str:
    return json.dumps(tree, indent=1)


# ---- Scenes.


def make_scene(folder: Path, rng: random.Random) -> None:
    """Write a mutated scene, shipped or random."""
    known = list(shipped_scenes().values())
    tree = random_scene(rng) if rng.random() < 0.4 else copy.deepcopy(content_of(rng.choice(known)))
    _written(folder / "scene.yaml", tree, rng)


def use_scene(folder: Path) -> None:
    """Read a scene, write it again, place its objects."""
    scene = pinograsp.load_scene(folder / "scene.yaml")
    require_finite(scene.to_dict(), "scene")
    if pinograsp.Scene.from_dict(scene.to_dict()) != scene:
        raise AssertionError("a scene is not what it says of itself")
    scene._repr_html_()
    for name, body in (*scene.obstacles.items(), *scene.objects.items()):
        require_finite(body.pose.matrix.tolist(), name)
        if body.shape.type != "mesh":
            surface = surface_of(body.shape)
            require_finite([surface.radius, *surface.signed_distance(np.full((1, 3), 0.1))[0].tolist()], name)
    for name, task in scene.tasks.items():
        require_finite([*scene.wrench_of(task).vector.tolist(), scene.mass_of(task)], name)
        check_placement(scene, name)


# ---- Robots.


def make_robot(folder: Path, rng: random.Random) -> None:
    """Write a mutated robot file: of the toy, beside its URDF, or of a shipped robot."""
    if rng.random() < 0.6:
        urdf, tree = random_robot(rng)
        (folder / "toy.urdf").write_text(urdf)
    else:
        file = rng.choice(list(shipped_robots().values()))
        for beside in file.parent.iterdir():
            shutil.copy(beside, folder)
        tree = copy.deepcopy(content_of(file))
    _written(folder / "robot.yaml", tree, rng)


def make_urdf(folder: Path, rng: random.Random) -> None:
    """Write the toy robot, or now and then a shipped one, with a mutated URDF."""
    if rng.random() < SHIPPED:
        tree, files = shipped(rng)
        (folder / "robot.yaml").write_text(yaml.safe_dump(tree | {"urdf": "toy.urdf"}))
        (folder / "toy.urdf").write_bytes(_mutated_xml(files["urdf"].read_text(), rng))
        return
    urdf, tree = random_robot(rng)
    (folder / "robot.yaml").write_text(yaml.safe_dump(tree))
    (folder / "toy.urdf").write_bytes(_mutated_xml(urdf, rng))


def make_srdf(folder: Path, rng: random.Random) -> None:
    """Write the toy robot, or now and then a shipped one, with a mutated SRDF."""
    tree, files = shipped(rng) if rng.random() < SHIPPED else ({}, {})
    if "srdf" in files:
        (folder / "robot.yaml").write_text(yaml.safe_dump(tree | {"urdf": str(files["urdf"]), "srdf": "toy.srdf"}))
        (folder / "toy.srdf").write_bytes(_mutated_xml(files["srdf"].read_text(), rng))
        return
    urdf, tree = random_robot(rng)
    pairs = '<disable_collisions link1="arm" link2="left" reason="Adjacent"/>' * 2
    pairs = pairs.replace("arm", tree["arm"]["wrist"])
    srdf = f'<robot name="toy"><group name="hand"><link name="left"/></group>{pairs}</robot>'
    (folder / "toy.urdf").write_text(urdf)
    (folder / "robot.yaml").write_text(yaml.safe_dump(tree | {"srdf": "toy.srdf"}))
    (folder / "toy.srdf").write_bytes(_mutated_xml(srdf, rng))


def _mutated_xml(text: str, rng: random.Random) -> bytes:
    document = ET.fromstring(text)
    if rng.random() >= RAW:
        mutate_xml(document, rng)
    data = ET.tostring(document)
    return mutate_bytes(data, rng) if rng.random() < RAW else data


def use_robot(folder: Path) -> None:
    """Load a robot and move it."""
    robot = pinograsp.load_robot(folder / "robot.yaml")
    require_finite([*robot.lower.tolist(), *robot.upper.tolist()], "limits")
    posture = 0.5 * (robot.lower + robot.upper)
    require_finite(robot.joints_by_name(posture), "joints")


# ---- Meshes.


def make_mesh(folder: Path, rng: random.Random) -> None:
    """Write a scene with a mutated mesh file."""
    source = rng.choice(sources(Path(SOURCES[0]))["mesh"])
    file = folder / f"body{source.suffix}"
    content = source.read_bytes()
    if rng.random() < 0.5 and not source.name.endswith("bin.stl"):
        words = content.decode().split(" ")
        words[rng.randrange(len(words))] = rng.choice(
            ["nan", "inf", "1e300", "-1", "99", "", "1.5", "x", "1e-300", "\n"]
        )
        content = " ".join(words).encode()
    file.write_bytes(mutate_bytes(content, rng) if rng.random() < 0.6 else content)
    tree = _with_mesh(random_scene(rng), file.name, rng.choice(("m", "mm")))
    (folder / "scene.yaml").write_text(yaml.safe_dump(tree))


def _with_mesh(scene: dict[str, Any], file: str, unit: str) -> dict[str, Any]:
    scene["objects"]["object 0"]["shape"] = {"type": "mesh", "file": file, "unit": unit}
    scene["tasks"]["task"].pop("allowed_contacts", None)
    return scene


def use_mesh(folder: Path) -> None:
    """Read a scene with a mesh and the mesh with it."""
    scene = pinograsp.load_scene(folder / "scene.yaml")
    surface = surface_of(scene.objects["object 0"].shape)
    require_finite([surface.radius], "mesh")
    if sum((folder / "scene.yaml").read_bytes()) % FIELDS == 0:
        require_finite(surface.signed_distance(np.zeros((1, 3)))[0].tolist(), "distance")


# ---- Results.


def make_result(folder: Path, rng: random.Random) -> None:
    """Write a mutated result."""
    _written(folder / "result.json", copy.deepcopy(content_of(rng.choice(sources(Path(SOURCES[0]))["result"]))), rng)


def use_result(folder: Path) -> None:
    """Read a result, and show and write it."""
    result = pinograsp.read_json(folder / "result.json")
    repr(result), result._repr_html_(), outcome_lines(result)
    if result.grasps:
        grasp_table(result).drawn(80)
        result.ranked("Q"), result.pareto(), result.different()
        require_finite([grasp.T_object_wrist.tolist() for grasp in result], "wrist")
    json.dumps(encode(result), allow_nan=False)


# ---- Databases.


def make_database(folder: Path, rng: random.Random) -> None:
    """Write a database with changed tables, rows, metadata or bytes."""
    file = folder / "small.duckdb"
    shutil.copy(rng.choice(sources(Path(SOURCES[0]))["database"]), file)
    if rng.random() < 0.3:
        file.write_bytes(mutate_bytes(file.read_bytes(), rng))
        return
    with (
        duckdb.connect(str(file)) as connection,
        contextlib.suppress(duckdb.Error),
    ):  # not all that is tried can be done
        _mutate_database(connection, rng)


def _mutate_database(connection: duckdb.DuckDBPyConnection, rng: random.Random) -> None:
    if rng.random() < 0.6:
        metadata = {key: json.loads(value) for key, value in connection.execute("FROM metadata").fetchall()}
        mutate_tree(metadata, rng)
        connection.execute("DELETE FROM metadata")
        for key, value in metadata.items():
            connection.execute("INSERT INTO metadata VALUES (?, ?)", [str(key).replace("\0", ""), json.dumps(value)])
    places = (("configurations", "q1"), ("configurations", "x"), ("batches", "drawn"), ("metadata", "value"))
    table, column = rng.choice(places)
    statements = (
        f"DROP TABLE {table}",
        f"ALTER TABLE {table} DROP COLUMN {column}",
        f"ALTER TABLE {table} RENAME COLUMN {column} TO other",
        f"ALTER TABLE {table} ADD COLUMN more DOUBLE",
        f"UPDATE {table} SET {column} = NULL",
        "UPDATE configurations SET x = 'nan' WHERE sample % 7 = 0",
        "UPDATE configurations SET q2 = 'inf' WHERE sample % 5 = 0",
        f"DELETE FROM {table}",
        "CREATE VIEW more AS SELECT * FROM read_text('/etc/hostname')",
        "CREATE MACRO isfinite(a) AS true",
    )
    if rng.random() < 0.6:
        connection.execute(rng.choice(statements))


def use_database(folder: Path) -> None:
    """Open a database, ask it and export it."""
    with Database.open(folder / "small.duckdb") as database:
        json.dumps(database.info(), allow_nan=False)
        found = configurations_near(database, [0.6, 0.0, 0.0], 0.5, limit=50)
        require_finite([found.q.tolist(), found.positions.tolist()], "configurations")
        spread_configurations(database, [0.6, 0.0, 0.0], 0.5, 20)
        database.export_parquet(folder / "out.parquet")
    exported = duckdb.sql(f"SELECT * FROM '{folder / 'out.parquet'}'").columns
    if any("hostname" in column for column in exported):
        raise AssertionError("an export holds another file")


def _database_info(folder: Path) -> list[str]:
    return ["database", "info", str(folder / "small.duckdb")]


# ---- Caches.


def make_cache(folder: Path, rng: random.Random) -> None:
    """Write nothing: the cache that is damaged is made where it is used."""
    (folder / "seed").write_text(str(rng.randrange(2**32)))


def use_cache(folder: Path) -> None:
    """Keep arrays, damage their file, and get them again."""
    rng, wanted = random.Random(int((folder / "seed").read_text())), np.arange(100.0)
    place = next(iter(cache_folders())) / "fuzz"

    def get() -> Any:
        return kept("fuzz", "arrays", lambda: wanted, lambda value: {"a": value}, lambda arrays: arrays["a"])

    get()
    file = place / "arrays.npz"
    file.write_bytes(mutate_bytes(file.read_bytes(), rng))
    if not np.array_equal(get(), wanted):
        raise AssertionError("a damaged cache was taken")


def require_finite(data: Any, what: str) -> None:
    """Refuse a number that is not finite, anywhere in data.

    Raises:
        SilentNaNError: there is one.
    """
    for number in _numbers(data):
        if not math.isfinite(number):
            raise SilentNaNError(what)


def _numbers(data: Any) -> Iterator[float]:
    if isinstance(data, Mapping):
        data = list(data.values())
    if isinstance(data, list | tuple):
        for part in data:
            yield from _numbers(part)
    elif isinstance(data, float):
        yield data


KINDS = {
    "scene": Kind(make_scene, use_scene, None),
    "robot": Kind(make_robot, use_robot, lambda folder: ["robot", "check", str(folder / "robot.yaml")]),
    "urdf": Kind(make_urdf, use_robot),
    "srdf": Kind(make_srdf, use_robot),
    "mesh": Kind(make_mesh, use_mesh, share=8),
    "result": Kind(make_result, use_result, lambda folder: ["rank", str(folder / "result.json")]),
    "database": Kind(
        make_database, use_database, lambda folder: ["database", "info", str(folder / "small.duckdb")], share=2
    ),
    "cache": Kind(make_cache, use_cache, share=4),
}
