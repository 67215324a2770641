"""Checks of what the parts of a scene say of each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import InputError
from .values import wrong, wrong_name

if TYPE_CHECKING:
    from .scene import Scene


def check_references(scene: Scene) -> None:
    """Raise what a validator raises where a task names no object, or cannot be about it, or two bodies share a name."""
    for name, task in scene.tasks.items():
        if task.object not in scene.objects:
            problem = f"no object {task.object!r} is defined"
            raise wrong_name(problem, task.object, list(scene.objects), "tasks", name, "object")
        try:
            scene.wrench_of(task)
        except InputError as error:
            raise wrong(error.problem, "tasks", name, remedy=error.remedy) from None
        try:
            scene.region_of(task)
        except InputError as error:
            key = "forbidden_contacts" if task.allowed_contacts is None else "allowed_contacts"
            raise wrong(error.problem, "tasks", name, key, remedy=error.remedy) from None
    for name in scene.obstacles:
        if name in scene.objects:
            raise wrong("an object has the same name", "obstacles", name, remedy="Rename one of them")
