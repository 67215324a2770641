"""What is mutated: shipped files, those that `prepare` makes once, and random scenes."""

from __future__ import annotations

import json
import pickle
import random
import shutil
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

import pinograsp
from pinograsp.descriptions import shipped_robots, shipped_scenes
from pinograsp.descriptions.locate import wheel_share

SOURCES: list[str] = []
"""The folder of `prepare`."""
LINKS = {".stl": 8, ".dae": 8, ".obj": 2}
"""How many small meshes of the wheels of robot models are mutated, too."""


@cache
def sources(folder: Path) -> dict[str, list[Path]]:
    """Return what is mutated of kinds that are not shipped: made once, by `prepare`."""
    return {kind.name: sorted(kind.glob("[!.]*")) for kind in folder.iterdir()}


def prepare(folder: Path) -> None:
    """Write sources to a folder: results of two starts each, a small database and meshes; check the shipped robots.

    What the check keeps in the cache is there for all inputs.
    """
    for name in ("result", "database", "mesh"):
        (folder / name).mkdir(parents=True)
    robot, scene = pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox")
    database = folder / "database" / "small.duckdb"
    pinograsp.build_database(robot, scene, database, size=1500, workers=1).close()
    for starts in (2, 4):
        result = pinograsp.plan(robot, scene, "sphere", starts=starts, workers=1, database=database)
        pinograsp.write_json(result, folder / "result" / f"{starts}.json")
    empty = scene.with_task("sphere", start_radius=1e-3)
    result = pinograsp.plan(robot, empty, "sphere", starts=2, workers=1, database=database)
    pinograsp.write_json(result, folder / "result" / "none.json")
    for name, file in shipped_robots().items():
        pinograsp.check_robot(file)
        for mesh in file.parent.glob("*.obj"):
            shutil.copy(mesh, folder / "mesh" / f"{name}-{mesh.name}")
    for suffix, content in _boxes().items():
        (folder / "mesh" / f"box.{suffix}").write_bytes(content)
    small = [file for file in wheel_share().rglob("*") if file.suffix.lower() in LINKS and file.is_file()]
    for suffix, count in LINKS.items():
        of_suffix = sorted((file.stat().st_size, str(file)) for file in small if file.suffix.lower() == suffix)
        for i, (_, name) in enumerate(of_suffix[: 2 * count : 2]):
            shutil.copy(name, folder / "mesh" / f"{i}-{Path(name).name}")


def meshes() -> list[Path]:
    """Return the mesh files that `prepare` wrote."""
    return sources(Path(SOURCES[0]))["mesh"]


def _boxes() -> dict[str, bytes]:
    """Return a box in every format that is small enough to be written here."""
    corners = np.array([[x, y, z] for x in (-0.02, 0.02) for y in (-0.03, 0.03) for z in (-0.04, 0.04)])
    faces = [
        (0, 1, 3),
        (0, 3, 2),
        (4, 6, 7),
        (4, 7, 5),
        (0, 4, 5),
        (0, 5, 1),
        (2, 3, 7),
        (2, 7, 6),
        (0, 2, 6),
        (0, 6, 4),
    ]
    faces += [(1, 5, 7), (1, 7, 3)]
    points = [" ".join(map(repr, corner)) for corner in corners.tolist()]
    obj = "\n".join([*(f"v {p}" for p in points), *("f " + " ".join(str(i + 1) for i in face) for face in faces)])
    off = "\n".join(["OFF", f"8 {len(faces)} 0", *points, *("3 " + " ".join(map(str, face)) for face in faces)])
    header = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    header += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    ply = header + "\n".join([*points, *("3 " + " ".join(map(str, face)) for face in faces)])
    parts = ["solid box"]
    binary = bytes(80) + len(faces).to_bytes(4, "little")
    for face in faces:
        parts += ["facet normal 0 0 0", "outer loop", *(f"vertex {points[i]}" for i in face), "endloop", "endfacet"]
        binary += np.concatenate([np.zeros(3), corners[list(face)].ravel()]).astype("<f4").tobytes() + bytes(2)
    stl = "\n".join([*parts, "endsolid box"])
    return {"obj": obj.encode(), "off": off.encode(), "ply": ply.encode(), "stl": stl.encode(), "bin.stl": binary}


def content_of(file: Path) -> Any:
    """Return what is in a JSON or YAML file, to be changed."""
    return pickle.loads(_pickled(file))


@cache
def _pickled(file: Path) -> bytes:
    text = file.read_text()
    return pickle.dumps(json.loads(text) if file.suffix == ".json" else yaml.safe_load(text))


@cache
def scene_files() -> list[Path]:
    """Return the files of the shipped scenes."""
    return sorted(shipped_scenes().values())


@cache
def robot_files() -> list[Path]:
    """Return the files of the shipped robots."""
    return sorted(shipped_robots().values())


def _number(rng: random.Random, least: float, most: float) -> float:
    return round(rng.uniform(least, most), 4)


def random_scene(rng: random.Random) -> dict[str, Any]:
    """Return the content of a scene file with random bodies in a random room."""

    def sizes(*names: str) -> dict[str, float]:
        return {name: _number(rng, 0.005, 0.08) for name in names}

    def shape(depth: int = 0) -> dict[str, Any]:
        kinds: list[dict[str, Any]] = [
            {"type": "sphere", **sizes("radius")},
            {"type": "box", "size": list(sizes("a", "b", "c").values())},
            {"type": "cylinder", **sizes("radius", "height")},
            {"type": "capsule", **sizes("radius", "length")},
            {"type": "ellipsoid", "semi_axes": list(sizes("a", "b", "c").values())},
            {"type": "cone", "bottom_radius": 0.03, "top_radius": 0.01, **sizes("height")},
        ]
        if depth == 0:
            kinds.append({"type": "compound", "parts": [{"shape": shape(1), "pose": pose()} for _ in range(2)]})
        return rng.choice(kinds)

    def pose() -> dict[str, Any]:
        return {
            "position": [_number(rng, 0.3, 0.9), _number(rng, -0.3, 0.3), _number(rng, -0.2, 0.2)],
            "rpy": [_number(rng, -3.0, 3.0) for _ in range(3)],
        }

    scene: dict[str, Any] = {
        "format": 1,
        "name": "random",
        "enclosure": {"min": [0.0, -0.5, -0.5], "max": [1.2, 0.5, 0.5]},
        "obstacles": {f"obstacle {i}": {"shape": shape(), "pose": pose()} for i in range(rng.randrange(3))},
        "objects": {
            f"object {i}": {"shape": shape(), "pose": pose(), "mass": 0.2} for i in range(1 + rng.randrange(2))
        },
    }
    task = {"object": "object 0", "contact": {"friction": _number(rng, 0.1, 1.5)}}
    if rng.random() < 0.5:
        task["allowed_contacts"] = rng.choice(
            (
                {"type": "half_space", "normal": [0.0, 0.0, 1.0], "offset": 0.0},
                {"type": "band", "z": [-0.01, 0.01]},
                {"type": "any_of", "parts": [{"type": "ball", "center": [0.0, 0.0, 0.02], "radius": 0.05}]},
            )
        )
    scene["tasks"] = {"task": task}
    return scene


def shipped(rng: random.Random) -> tuple[dict[str, Any], dict[str, Path]]:
    """Return the content of the file of a shipped robot, and its URDF and SRDF, wherever they are."""
    file = rng.choice(robot_files())
    return content_of(file), files_of(file)


@cache
def files_of(file: Path) -> dict[str, Path]:
    """Return the URDF and the SRDF of a robot file."""
    description = pinograsp.load_robot(file).description
    names = {"urdf": description.urdf_file, "srdf": description.srdf_file}
    return {kind: name for kind, name in names.items() if name is not None}
