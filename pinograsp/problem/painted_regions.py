"""Check that something is painted where a task says that contact may or must not be."""

from __future__ import annotations

from ..descriptions import Scene
from ..descriptions.mesh_files import described_meshes
from ..descriptions.regions import Painted, on_object
from ..errors import FileError
from ..geometry.painted import painted_surface


def check_paint(scene: Scene, task_name: str) -> None:
    """Refuse painted regions of a task of which nothing is there.

    Raises:
        FileError: a region's mesh file cannot be used, or nothing in it is painted so; file and key of the scene.
    """
    task = scene.task(task_name)
    for key, region in described_meshes(task, f"tasks.{task_name}"):
        whole = on_object(region, scene.objects[task.object].shape) if isinstance(region, Painted) else None
        if isinstance(whole, Painted):
            try:
                painted_surface(whole)
            except FileError as error:
                problem, named = f"{error.file} {error.problem}", key if region.file is None else f"{key}.file"
                raise FileError(problem, file=scene.source, key=named, remedy=error.remedy) from None
