"""Benchmark of what is prepared once of a mesh: for the optimiser, and by the check on its own.

    python tools/benchmark_prepare.py [OBJECT ...]

Takes the meshes of `foreign_objects.yaml`, by default all. The cache folder is an empty one for the time; what Numba
compiles is compiled before. Prints a Markdown table with a row for each mesh: wall and processor time of the repair,
the field and the points of the optimiser, and what of them is kept; and the same times of the body of the check.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import cast

import numpy as np

from foreign_objects import fetch, foreign_objects
from pinograsp import Mesh
from pinograsp.geometry.point_trees import point_trees
from pinograsp.geometry.shapes import UnevenSurface, surface_of
from pinograsp.verification.object_mesh import object_mesh

COLUMNS = ("object", "triangles", "optimiser, s", "processor, s", "kept, MB", "check, s", "processor, s")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("objects", nargs="*", metavar="object", help="names of some; all if not given")
    names = parser.parse_args().objects
    known = foreign_objects()
    if unknown := set(names) - set(known):
        parser.error(f"unknown: {', '.join(sorted(unknown))}; known: {', '.join(known)}")
    chosen = {name: known[name] for name in names or known}
    fetch(chosen.values())
    meshes = {
        name: Mesh(file=thing.file, scale=thing.scale, unit="m", largest_hole=thing.largest_hole)
        for name, thing in chosen.items()
    }
    print(f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|", sep="\n")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["PINOGRASP_CACHE"] = folder
        smallest = min(chosen, key=lambda name: chosen[name].triangles)
        for_the_optimiser(meshes[smallest].model_copy(update={"scale": 0.9 * chosen[smallest].scale}))
        for_the_check(meshes[smallest].model_copy(update={"scale": 0.9 * chosen[smallest].scale}))
        for name, mesh in meshes.items():
            before = kept(Path(folder))
            cells = [name, f"{chosen[name].triangles:,}", *timed(partial(for_the_optimiser, mesh))]
            cells += [f"{1e-6 * (kept(Path(folder)) - before):.1f}", *timed(partial(for_the_check, mesh))]
            print(f"| {' | '.join(cells)} |", flush=True)


def timed(work: Callable[[], None]) -> tuple[str, str]:
    """Return wall and processor time, s."""
    wall, processor = time.perf_counter(), time.process_time()
    work()
    return f"{time.perf_counter() - wall:.1f}", f"{time.process_time() - processor:.1f}"


def for_the_optimiser(mesh: Mesh) -> None:
    """Prepare all that a solve asks of a mesh."""
    surface, origin = cast(UnevenSurface, surface_of(mesh)), np.zeros((1, 3))
    surface.nearest_points(point_trees([origin], [0]), np.eye(3)[None], origin, np.zeros(1), np.full(1, 0.03))
    surface.deepest_point(np.eye(3), np.ones(3))
    surface.exact_distances(origin)


def for_the_check(mesh: Mesh) -> None:
    """Prepare the body that grasps are checked with."""
    body = object_mesh(mesh)
    assert body.sigma > 0.0
    assert body.solid is not None


def kept(folder: Path) -> int:
    """Return the bytes of all files in a folder."""
    return sum(file.stat().st_size for file in folder.rglob("*.npz"))


if __name__ == "__main__":
    main()
