"""Scenes and the meshes of their objects, damaged and used."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np

import pinograsp
from fuzz_kind import require_finite, written, yaml_text
from fuzz_mutations import mutate_mesh
from fuzz_sources import content_of, meshes, random_scene, scene_files
from pinograsp.geometry.shapes import surface_of
from pinograsp.problem.checks import check_placement

FIELDS = 30
"""Of so many meshes, one has its distance field made, which takes most of a second."""


def make_scene(folder: Path, rng: random.Random) -> None:
    """Write a mutated scene, shipped or random."""
    tree = random_scene(rng) if rng.random() < 0.4 else content_of(rng.choice(scene_files()))
    written(folder / "scene.yaml", tree, rng)


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


def make_mesh(folder: Path, rng: random.Random) -> None:
    """Write a scene with a mutated mesh file."""
    source = rng.choice(meshes())
    file = folder / f"body{source.suffix.lower()}"
    file.write_bytes(mutate_mesh(source.read_bytes(), rng))
    tree = with_mesh(random_scene(rng), file.name, rng.choice(("m", "mm")))
    (folder / "scene.yaml").write_text(yaml_text(tree))


def with_mesh(scene: dict[str, Any], file: str, unit: str) -> dict[str, Any]:
    """Return a scene whose first object is a mesh."""
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
