"""Preparation of the meshes of a scene: what takes seconds when a mesh is met for the first time on a machine."""

from __future__ import annotations

from ..descriptions import Scene, Task
from ..descriptions.mesh_files import mesh_files
from ..descriptions.shapes import Mesh
from ..geometry.shapes.mesh import body_surface
from ..progress import Progress, Report


def prepare_meshes(scene: Scene, task: Task, report: Report) -> None:
    """Have the distance field of a task's object and the convex pieces of the other bodies computed, or found.

    Args:
        scene: of the task.
        task: its object is the one that is touched.
        report: called before every mesh.

    Raises:
        FileError: a file cannot be read, has changed since it was described, or encloses no body.
    """
    bodies = [scene.objects[task.object], *scene.bodies_besides(task).values()]
    meshes = [(body, file) for body in bodies for _, file in mesh_files(body.shape) if isinstance(file, Mesh)]
    for number, (body, mesh) in enumerate(meshes):
        report(Progress("meshes", number, len(meshes)))
        if body is bodies[0]:
            _ = body_surface(mesh).field
        else:
            body_surface(mesh).solids()
