"""A scene as a notebook shows it: tables of its bodies and of its tasks."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from .. import notebook
from .shapes import Compound, Mesh, ShapeDescription

if TYPE_CHECKING:
    from .scene import Scene


def scene_html(scene: Scene) -> str:
    """Return the tables as HTML."""
    low, high = (_in_brackets(corner) for corner in (scene.enclosure.min, scene.enclosure.max))
    bodies = [
        notebook.row((name, role, _shown(body.shape), _in_brackets(body.pose.position)))
        for role, named in (("object", scene.objects), ("obstacle", scene.obstacles))
        for name, body in named.items()
    ]
    tasks = [
        notebook.row((name, task.object, _in_brackets(scene.wrench_of(task).force), f"{task.contact.friction:g}"))
        for name, task in scene.tasks.items()
    ]
    caption = f"Scene {scene.name}: enclosure from {low} to {high} m"
    listed = notebook.table(caption, bodies, ("body", "role", "shape, m", "position, m"))
    return listed + notebook.table("Tasks", tasks, ("task", "object", "external force, N", "friction"))


def _in_brackets(numbers: Iterable[float]) -> str:
    return "(" + ", ".join(f"{number:g}" for number in numbers) + ")"


def _shown(shape: ShapeDescription) -> str:
    if isinstance(shape, Compound):
        return "compound of " + ", ".join(part.shape.type for part in shape.parts)
    if isinstance(shape, Mesh):
        return f"mesh {shape.file.name}"
    sizes = shape.model_dump(exclude={"type"}).items()
    shown = [f"{key} {_in_brackets(size) if isinstance(size, tuple) else f'{size:g}'}" for key, size in sizes]
    return ", ".join([shape.type, *shown])
