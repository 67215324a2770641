"""Scenes: enclosure, mounting of the arm, obstacles, objects and tasks; read from a file or made in Python.

World frame as the scene's author chooses it; lengths in metres, angles in radians, forces in newtons.
"""

from __future__ import annotations

import json
import reprlib
from collections.abc import Mapping
from typing import Any, Self, TypeVar

import numpy as np
from pydantic import Field, ValidationInfo, model_validator

from ..arrays import Rows
from ..disk import digest
from ..errors import InputError, UnknownNameError, close_names, require_kind
from ..interrupts import held
from .bodies import Body, Object
from .enclosure import Enclosure
from .mesh_files import CONTENT, content_hashes
from .model import FileRoot, Frozen
from .pose import Pose
from .problems import INTERNAL, refuse_internal
from .regions import Region, on_object
from .scene_html import scene_html
from .scene_references import check_references
from .task import Task, Wrench
from .values import (
    ABSENT,
    FileName,
    FilePath,
    Format1,
    Name,
    Table,
    Vector3,
    as_default,
    empty,
)
from .weight import weight_of

Part = TypeVar("Part", bound=Frozen)
STANDARD_GRAVITY = 9.80665
"""On Earth, m/s^2."""
DOWN = (0.0, 0.0, -STANDARD_GRAVITY)
"""Gravity of a scene that says nothing else, m/s^2, world."""


class Scene(FileRoot):
    """Enclosure, obstacles, objects and tasks.

    Scenes are equal if they say the same, wherever they come from.
    """

    format: Format1 = 1
    """Version of the file's format."""
    source: FilePath | None = Field(default=None, init=False, repr=False)
    """The file that it was read from; None if it was made in Python, by changing another one too."""
    digest: str = Field(default="", init=False, repr=False)
    """SHA-256 in hexadecimal: of the file's bytes, or of the content if it was made in Python; and of mesh files."""
    name: FileName
    """Of the scene; part of the names of its files of results."""
    description: str = ""
    """For who reads the file or `pinograsp list`."""
    enclosure: Enclosure
    """The room that the robot must stay in, m, world."""
    mounting: Pose = Pose()
    """Pose of the robot's root link in the world."""
    gravity: Vector3 = as_default(DOWN)
    """Acceleration of free fall, m/s^2, world, in any direction; zeros where nothing falls."""
    obstacles: Table[Name, Body] = Field(default_factory=empty)
    """Bodies that stay where they are, by name."""
    objects: Table[Name, Object]
    """Bodies to grasp, by name."""
    tasks: Table[FileName, Task]
    """Tasks by name."""

    @model_validator(mode="after")
    def _references(self) -> Self:
        check_references(self)
        return self

    @model_validator(mode="after")
    def _digested(self, info: ValidationInfo) -> Self:
        if self.source is None or not self.digest:
            content = json.dumps(self._to_dict(CONTENT), sort_keys=True)
            self.__dict__["digest"] = digest(content.encode())
        elif info.context and (meshes := content_hashes(self)):  # where a file is read, not a result
            self.__dict__["digest"] = digest(json.dumps([self.digest, meshes]).encode())
        return self

    def _repr_html_(self) -> str:
        """Return the bodies and the tasks as tables, as a notebook shows them."""
        return scene_html(self)

    def __eq__(self, other: object) -> bool:
        """Whether another scene says the same."""
        return self.to_dict() == other.to_dict() if isinstance(other, Scene) else NotImplemented

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Return the scene that a file of this content would give.

        Args:
            data: the content of a YAML file, `format: 1` and every `type` included.

        Raises:
            InputError: a key is unknown or missing, or a value is wrong; the message names the key.
        """
        if not isinstance(data, Mapping):
            raise InputError(f"must be a mapping of keys, not {data!r}", key="data")
        refuse_internal(data)
        return cls._made({"format": ABSENT, **data})

    def to_dict(self) -> dict[str, Any]:
        """Return the content as a YAML file has it: lists, texts, numbers and dicts of these; `from_dict` reads it."""
        return self._to_dict()

    def _to_dict(self, context: Any = None) -> dict[str, Any]:
        # Without the gravity of scenes that say nothing about it, whose digests are older than this key.
        standard = {"gravity"} if self.gravity == DOWN else set()
        with held():  # pydantic would make an error of the scene of an interrupt
            return self.model_dump(mode="json", exclude={*INTERNAL, *standard}, exclude_none=True, context=context)

    def task(self, name: str) -> Task:
        """Return a task by name.

        Raises:
            UnknownNameError: there is none of this name.
        """
        return self._named("task", name, self.tasks)

    def with_object_pose(self, name: str, pose: Pose | Rows) -> Self:
        """Return the scene with an object at another pose.

        Args:
            name: of the object.
            pose: of the object in the world; as an array: homogeneous, m, shape (4, 4).

        Raises:
            UnknownNameError: there is no object of this name.
            InputError: the array is no pose.
        """
        there = {"pose": pose if isinstance(pose, Pose) else Pose.of(pose)}
        return self._with("objects", name, self._named("object", name, self.objects).model_copy(update=there))

    def with_object(self, name: str, object: Object) -> Self:
        """Return the scene with an object more, or with another one of a name.

        Args:
            name: of the object.
            object: as it is from now on.

        Raises:
            InputError: an obstacle has this name, or it is no object.
        """
        return self._with("objects", name, object)

    def without_object(self, name: str) -> Self:
        """Return the scene without one of its objects.

        Args:
            name: of the object.

        Raises:
            UnknownNameError: there is no object of this name.
            InputError: a task is about it.
        """
        self._named("object", name, self.objects)
        for task, content in self.tasks.items():
            if content.object == name:
                remedy = "Take that away first, with `without_task`"
                raise InputError(f"task {task!r} is about it", key=f"objects.{name}", remedy=remedy)
        return self._without("object", name, self.objects)

    def with_obstacle(self, name: str, body: Body) -> Self:
        """Return the scene with an obstacle more, or with another one of a name.

        Args:
            name: of the obstacle.
            body: as it is from now on.

        Raises:
            InputError: an object has this name, or it is no body.
        """
        return self._with("obstacles", name, body)

    def without_obstacle(self, name: str) -> Self:
        """Return the scene without one of its obstacles.

        Args:
            name: of the obstacle.

        Raises:
            UnknownNameError: there is no obstacle of this name.
        """
        return self._without("obstacle", name, self.obstacles)

    def without_task(self, name: str) -> Self:
        """Return the scene without one of its tasks.

        Args:
            name: of the task.

        Raises:
            UnknownNameError: there is no task of this name.
        """
        return self._without("task", name, self.tasks)

    def with_task(self, name: str, task: Task | None = None, **changes: Any) -> Self:
        """Return the scene with a task more, or with another one of a name.

        Args:
            name: of the task.
            task: to take; None: the scene's own task of this name, changed.
            changes: keys of the task with other values, such as `lock={"joint_7": 0.0}`.

        Raises:
            UnknownNameError: no task is given and there is none of this name, or its object is not in the scene.
            InputError: a change is of an unknown key, or a value is wrong.
        """
        if task is None:
            task = self.task(name)
        if changes:
            require_kind("task", task, Task)
        return self._with("tasks", name, {**task.fields(), **changes} if changes else task)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return the scene with some fields replaced, validated as a file is.

        Args:
            update: values by field.
            deep: makes no difference: nothing of a scene can be changed.

        Raises:
            InputError: a field is unknown, or a value is wrong; the message names the key.
        """
        refuse_internal(update or {})
        return super().model_copy(update={**update, "source": None, "digest": ""} if update else None, deep=deep)

    def bodies_besides(self, task: Task) -> dict[str, Body]:
        """Return what the robot must keep clear of in this task: obstacles and the other objects."""
        others = {name: body for name, body in self.objects.items() if name != task.object}
        return {**self.obstacles, **others}

    def wrench_of(self, task: Task) -> Wrench:
        """Return the external wrench on the object of a task: the task's own, else the weight of the object.

        Raises:
            UnknownNameError: the object is none of the scene.
            TaskError: the task has no wrench and the object no mass, or the weight is out of range.
        """
        if task.wrench is not None:
            return task.wrench
        self._named("object", task.object, self.objects)
        return weight_of(self, task.object)

    def region_of(self, task: Task) -> Region | None:
        """Return the part of the object's surface that contacts must be on; None: all of it.

        Raises:
            UnknownNameError: the object is none of the scene.
            InputError: a painted region names no file, and the object is no mesh.
        """
        shape = self._named("object", task.object, self.objects).shape
        return None if task.contact_region is None else on_object(task.contact_region, shape)

    def mass_of(self, task: Task) -> float | None:
        """Return the mass of the object of a task, kg: its own, else what the task's force weighs in this gravity.

        None if that is nothing: without a force, or without gravity.

        Raises:
            UnknownNameError: the object is none of the scene.
        """
        mass = self._named("object", task.object, self.objects).mass
        if mass is not None or task.wrench is None:
            return mass
        weight, gravity = (float(np.linalg.norm(vector)) for vector in (task.wrench.force, self.gravity))
        return weight / gravity if weight > 0.0 and gravity > 0.0 else None

    def _named(self, what: str, name: str, table: Mapping[str, Part]) -> Part:
        if not isinstance(name, str) or name not in table:
            shown = (
                repr(name) if isinstance(name, str) else reprlib.repr(name)
            )  # such as the part itself, which is long
            problem, remedy = f"no {what} {shown} in this scene", close_names(name, table)
            raise UnknownNameError(problem, file=self.source, key=f"{what}s", remedy=remedy)
        return table[name]

    def _with(self, table: str, name: str, part: object) -> Self:
        require_kind("name", name, str)
        return self.model_copy(update={table: {**getattr(self, table), name: part}})

    def _without(self, what: str, name: str, table: Mapping[str, Part]) -> Self:
        self._named(what, name, table)
        return self.model_copy(update={f"{what}s": {other: part for other, part in table.items() if other != name}})
