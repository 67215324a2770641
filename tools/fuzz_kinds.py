"""The kinds of files that pinograsp reads: how a damaged one is made, and what a user does with it.

A kind is an entry of `KINDS`: `make` writes the files of an input to a folder, `use` reads them as a user would and
goes on with what was read. Whatever comes of that must be a `PinograspError`, or right.
"""

from __future__ import annotations

import contextlib
import gc
import random
import shutil
from pathlib import Path

import pinograsp
from fuzz_files import make_cache, make_database, make_result, use_cache, use_database, use_result
from fuzz_judge import commanded
from fuzz_kind import Kind, yaml_text
from fuzz_robots import make_link, make_robot, make_srdf, make_urdf, use_link, use_robot
from fuzz_scenes import make_mesh, make_scene, use_mesh, use_scene, with_mesh
from fuzz_sources import SOURCES, content_of, files_of, meshes, random_scene, robot_files, scene_files, sources
from fuzz_toy import random_robot

KINDS = {
    "scene": Kind(make_scene, use_scene),
    "robot": Kind(make_robot, use_robot, lambda folder: ["robot", "check", str(folder / "robot.yaml")]),
    "urdf": Kind(make_urdf, use_robot),
    "srdf": Kind(make_srdf, use_robot),
    "mesh": Kind(make_mesh, use_mesh, share=8),
    "link": Kind(make_link, use_link, share=5),
    "result": Kind(make_result, use_result, lambda folder: ["rank", str(folder / "result.json")]),
    "database": Kind(
        make_database, use_database, lambda folder: ["database", "info", str(folder / "small.duckdb")], share=2
    ),
    "cache": Kind(make_cache, use_cache, share=4),
}


def warm(folder: Path) -> None:
    """Use sound inputs, so that libraries are loaded and functions compiled before time counts; opens no database."""
    for number in range(20):
        rng = random.Random(number)
        (folder / "scene.yaml").write_text(yaml_text(random_scene(rng)))
        with contextlib.suppress(pinograsp.PinograspError):  # bodies may lie in each other
            use_scene(folder)
    urdf, tree = random_robot(random.Random(0))
    (folder / "toy.urdf").write_text(urdf)
    for content in (tree | {"more": 0}, tree):
        (folder / "robot.yaml").write_text(yaml_text(content))
        with contextlib.suppress(pinograsp.PinograspError):
            use_robot(folder)
    use_link(folder)
    commanded(["robot", "check", str(folder / "robot.yaml")])
    for source in meshes() if SOURCES else ():
        file = folder / f"body{source.suffix.lower()}"
        shutil.copy(source, file)
        (folder / "scene.yaml").write_text(yaml_text(with_mesh(random_scene(rng), file.name, "m")))
        with contextlib.suppress(pinograsp.PinograspError):  # of a wheel: it may be open
            use_mesh(folder)
    for source in sources(Path(SOURCES[0]))["result"] if SOURCES else ():
        shutil.copy(source, folder / "result.json")
        use_result(folder)
        commanded(["rank", str(folder / "result.json")])
    for file in (*scene_files(), *robot_files()):
        content_of(file)
    for file in robot_files():
        files_of(file)
    gc.collect()
    gc.freeze()  # children that collect garbage write to no page of what is here
