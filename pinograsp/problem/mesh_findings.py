"""What was taken for granted or mended in the mesh files of a scene, in words."""

from __future__ import annotations

from collections.abc import Iterator

from ..descriptions import Scene, Task
from ..descriptions.mesh_files import mesh_files
from ..descriptions.regions import Painted
from ..descriptions.shapes import Mesh
from ..geometry.object_mesh import object_mesh


def mesh_findings(scene: Scene, task: Task) -> Iterator[str]:
    """Yield what is to be known of the meshes of a scene's bodies and of a task's painted regions.

    Raises:
        FileError: a file cannot be read, has changed since it was described, or encloses no body.
    """
    for name, body in {**scene.objects, **scene.obstacles}.items():
        for _, file in mesh_files(body.shape):
            if isinstance(file, Mesh):
                yield from (f"mesh of {name!r}: {finding}" for finding in object_mesh(file).findings)
    for _, file in mesh_files(scene.region_of(task)):
        if isinstance(file, Painted) and file.mesh is not None:
            mesh = object_mesh(file.mesh)
            if file.mesh != scene.objects[task.object].shape:
                yield from (f"painted mesh {file.mesh.file.name}: {finding}" for finding in mesh.findings)
            if file.color is not None and mesh.paint.sampled:
                yield f"painted with {file.words}: colours of the texture in the middle of each triangle were taken"
