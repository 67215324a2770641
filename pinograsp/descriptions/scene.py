"""Scenes: enclosure, mounting of the arm, obstacles, objects and tasks; read from a file or made in Python.

World frame as the scene's author chooses it; lengths in metres, angles in radians, forces in newtons.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError, field_validator, model_validator

from .. import notebook
from ..arrays import Array
from ..disk import digest
from ..errors import InputError, UnknownNameError, close_names, require_kind
from ..frozen import FrozenMapping, frozen
from . import locate
from .hand import ContactModel
from .model import FileRoot, Frozen
from .pose import ZERO, Pose
from .problems import INTERNAL, input_error
from .regions import AllOf, Outside, Region
from .shapes import Shape, ShapeDescription
from .values import (
    ABSENT,
    FileName,
    Format1,
    Name,
    NotNegative,
    Number,
    Positive,
    Range,
    Table,
    UnitVector3,
    Vector3,
    empty,
    listed,
    unknown,
    wrong,
)


class Enclosure(Frozen):
    """The inside of a box-shaped room, m, edges along the world axes; its six walls are half-spaces."""

    min: Vector3
    """Corner of the least coordinates, m, world."""
    max: Vector3
    """Corner of the greatest coordinates, m, world."""

    @model_validator(mode="after")
    def _ordered(self) -> Enclosure:
        for axis, letter in enumerate("xyz"):
            if self.min[axis] >= self.max[axis]:
                raise wrong(f"min {self.min[axis]:g} is not below max {self.max[axis]:g} along {letter}", "min", axis)
        return self

    @cached_property
    def walls(self) -> Mapping[str, tuple[Array, float]]:
        """Name to (inward normal n, shape (3,), and offset d, m): the inside is n . p >= d, world."""
        walls: dict[str, tuple[Array, float]] = {}
        for axis, letter in enumerate("xyz"):
            inward = np.eye(3)[axis]
            walls[f"wall {letter}={self.min[axis]:g}"] = (inward, self.min[axis])
            walls[f"wall {letter}={self.max[axis]:g}"] = (-inward, -self.max[axis])
        return FrozenMapping(walls)


class Body(Frozen):
    """A shape at a pose: an obstacle or an object."""

    shape: Shape
    pose: Pose = Pose()
    """Of the shape's frame in the world, m and rad."""


class Object(Body):
    """Something to grasp; in the tasks of other objects it is an obstacle."""

    center_of_mass: Vector3 = ZERO
    """In the object's frame, m."""
    mass: Positive | None = None
    """kg; by default what a task's external force weighs on Earth."""

    @cached_property
    def center_of_mass_world(self) -> Array:
        """Centre of mass in the world, m, shape (3,); read-only."""
        T = self.pose.matrix
        return np.asarray(frozen(T[:3, :3] @ np.array(self.center_of_mass) + T[:3, 3]))


class Wrench(Frozen):
    """External wrench on the object: force, N, and torque about the centre of mass, N m, world frame."""

    force: Vector3
    """N, world."""
    torque: Vector3 = ZERO
    """About the centre of mass, N m, world."""

    @cached_property
    def vector(self) -> Array:
        """The wrench as (force, torque), N and N m, shape (6,); read-only."""
        return np.asarray(frozen(np.array([*self.force, *self.torque])))


class ContactConstants(Frozen):
    """Friction and force limits of the force problem, (17), (18) and appendix A."""

    friction: Positive
    """Static friction coefficient mu_s."""
    min_normal_force: NotNegative = 0.001
    """f_min, N."""
    max_force: Positive = 5.0
    """f_max on the norm of a contact force, N."""
    kappa: Positive = 0.01
    """Margin below which the barrier of (A6) becomes quadratic, N."""

    @model_validator(mode="after")
    def _ordered(self) -> ContactConstants:
        if self.min_normal_force >= self.max_force:
            raise wrong(f"must be below max_force, {self.max_force:g} N", "min_normal_force")
        return self


class Margins(Frozen):
    """Least distances, m."""

    enclosure: NotNegative = 0.005
    """Robot to walls, obstacles and other objects (16), m."""
    robot: NotNegative = 0.005
    """Robot to itself, m."""
    object: NotNegative = 0.001
    """Links that are no pads, and what stands out beside a pad, to the object, m: only pads are to carry it."""


class Reserves(Frozen):
    """How far a grasp keeps from where joints and pads end."""

    joint: NotNegative = 0.02
    """Arm joints from their limits, rad (m)."""
    rim: NotNegative = 0.0005
    """Contact points from the rims of their pads and from the edges of the object's surface, m.

    An object that a pad touches with its very rim tips over it: of such grasps up to half did not even hold still in
    simulation, of those half a millimetre away all.
    """


class ApproachCone(Frozen):
    """A cone of approach directions: the wrist's z axis lies within `angle` of `direction`."""

    direction: UnitVector3
    """Where the hand points, length 1: (0, 0, -1) is from above."""
    angle: Annotated[Number, Field(gt=0.0, le=math.pi)]
    """Half-angle of the cone, rad."""
    frame: Literal["world", "object"] = "world"
    """Frame of `direction`."""


class JointInterval(NamedTuple):
    """An interval in which an arm joint or a synergy is to be, rad (m)."""

    key: Literal["joint_ranges", "lock"]
    """Of the task, where it stands."""
    name: str
    lower: float
    upper: float


class Task(Frozen):
    """A job for the hand: which object to hold, where, and against which wrench."""

    object: Name
    """Name of an object of the scene."""
    desired_contacts: Annotated[tuple[Vector3, ...], Field(min_length=2), BeforeValidator(listed)]
    """Desired contact points on the object's surface, in the object's frame, m; one for each pad."""
    pads: Annotated[tuple[Name, ...], Field(min_length=2)] | None = None
    """Names of the robot's pads that are to touch the object; all if not given. The nearest takes each point."""
    wrench: Wrench
    contact: ContactConstants
    force_weight: NotNegative = 1.0
    """k of (10), mm^2: weight of V against the squared contact distances."""
    margin: Margins = Margins()
    reserve: Reserves = Reserves()
    contact_model: ContactModel | None = None
    """Contact model of every pad, in place of what the robot file says."""
    allowed_contacts: Region | None = None
    """Part of the object's surface where contact is allowed, object's frame; everywhere if not given."""
    forbidden_contacts: Region | None = None
    """Part of the object's surface where contact is forbidden, object's frame."""
    contact_regions: Literal["footprint", "point"] = "footprint"
    """Part of a contact that has to be where contact may be: the footprint, or the contact point alone (the paper)."""
    withstand: Positive | None = None
    """Least acceleration of the object in any direction that its grasp must withstand, m/s^2; none if not given."""
    approach: ApproachCone | None = None
    """Approach directions that are wanted; every direction if not given."""
    joint_ranges: Table[Name, Range] = Field(default_factory=empty)
    """Ranges of arm joints and synergies within the robot's limits, rad (m); one of no width locks its joint.

    Whole turns of a continuous joint do not count: [3.0, 3.5] holds the reported angle -3.1, which is 3.18 less a turn.
    """
    lock: Table[Name, Number] = Field(default_factory=empty)
    """Values at which arm joints and synergies stay, rad (m), within the robot's limits less the joint reserve.

    Whole turns of a continuous joint do not count. A joint may have a range, too, which then has to hold the value.
    """
    balance_wrench: bool = True
    """Whether the part of the wrench that no contact force balances must vanish (the paper: false)."""
    start_radius: Positive = 0.3
    """Starts have their wrist within this distance of the object's centre of mass, m."""

    @field_validator("pads")
    @classmethod
    def _pads_once(cls, value: tuple[str, ...] | None) -> tuple[str, ...] | None:
        for index, name in enumerate(value or ()):
            if name in (value or ())[:index]:
                raise wrong(f"{name!r} is given twice", index)
        return value

    @cached_property
    def contact_region(self) -> Region | None:
        """Where contact may be: allowed and not forbidden; None for everywhere."""
        parts: list[Region] = [] if self.allowed_contacts is None else [self.allowed_contacts]
        if self.forbidden_contacts is not None:
            parts.append(Outside(part=self.forbidden_contacts))
        return AllOf(parts=tuple(parts)) if len(parts) > 1 else parts[0] if parts else None

    @cached_property
    def intervals(self) -> tuple[JointInterval, ...]:
        """All that the task asks of joints: the ranges, then the locks as intervals of no width, rad (m)."""
        ranges = (JointInterval("joint_ranges", name, *ends) for name, ends in self.joint_ranges.items())
        locks = (JointInterval("lock", name, value, value) for name, value in self.lock.items())
        return (*ranges, *locks)


class Scene(FileRoot):
    """Enclosure, obstacles, objects and tasks.

    Scenes are equal if they say the same, wherever they come from.
    """

    format: Format1 = 1
    source: Path | None = Field(default=None, init=False, repr=False)
    """The file that it was read from; None if it was made in Python, by changing another one too."""
    digest: str = Field(default="", init=False, repr=False)
    """SHA-256 in hexadecimal: of the file's bytes, or of the content if it was made in Python."""
    name: FileName
    description: str = ""
    enclosure: Enclosure
    mounting: Pose = Pose()
    """Pose of the robot's root link in the world."""
    obstacles: Table[Name, Body] = Field(default_factory=empty)
    """Bodies that stay where they are, by name."""
    objects: Table[Name, Object]
    """Bodies to grasp, by name."""
    tasks: Table[FileName, Task]
    """Tasks by name."""

    @model_validator(mode="after")
    def _references(self) -> Self:
        for name, task in self.tasks.items():
            if task.object not in self.objects:
                problem = f"no object {task.object!r} is defined"
                raise unknown(problem, task.object, list(self.objects), "tasks", name, "object")
        for name in self.obstacles:
            if name in self.objects:
                raise wrong("an object has the same name", "obstacles", name, remedy="Rename one of them")
        return self

    @model_validator(mode="after")
    def _digested(self) -> Self:
        if self.source is None or not self.digest:
            content = json.dumps(self.to_dict(), sort_keys=True)
            self.__dict__["digest"] = digest(content.encode())
        return self

    def _repr_html_(self) -> str:
        """Return the bodies and the tasks as tables, as a notebook shows them."""
        low, high = (_in_brackets(corner) for corner in (self.enclosure.min, self.enclosure.max))
        bodies = [
            notebook.row((name, role, _shown(body.shape), _in_brackets(body.pose.position)))
            for role, named in (("object", self.objects), ("obstacle", self.obstacles))
            for name, body in named.items()
        ]
        tasks = [
            notebook.row((name, task.object, _in_brackets(task.wrench.force), f"{task.contact.friction:g}"))
            for name, task in self.tasks.items()
        ]
        caption = f"Scene {self.name}: enclosure from {low} to {high} m"
        listed = notebook.table(caption, bodies, ("body", "role", "shape, m", "position, m"))
        return listed + notebook.table("Tasks", tasks, ("task", "object", "external force, N", "friction"))

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
        for reserved in INTERNAL:
            if reserved in data:
                raise InputError("unknown key", key=reserved, remedy="Remove it")
        return cls._made({"format": ABSENT, **data})

    def to_dict(self) -> dict[str, Any]:
        """Return the content as a YAML file has it: lists, texts, numbers and dicts of these; `from_dict` reads it."""
        return self.model_dump(mode="json", exclude={*INTERNAL}, exclude_none=True)

    def task(self, name: str) -> Task:
        """Return a task by name.

        Raises:
            UnknownNameError: there is none of this name.
        """
        self._require("task", name, self.tasks)
        return self.tasks[name]

    def with_object_pose(self, name: str, pose: Pose | Array) -> Self:
        """Return the scene with an object at another pose.

        Args:
            name: of the object.
            pose: of the object in the world; as an array: homogeneous, m, shape (4, 4).

        Raises:
            UnknownNameError: there is no object of this name.
            InputError: the array is no pose.
        """
        self._require("object", name, self.objects)
        there = pose if isinstance(pose, Pose) else Pose.of(pose)
        return self._with("objects", name, {**self.objects[name].fields(), "pose": there})

    def with_object(self, name: str, object: Object) -> Self:
        """Return the scene with an object more, or with another one of a name.

        Args:
            name: of the object.
            object: as it is from now on.

        Raises:
            InputError: an obstacle has this name, or it is no object.
        """
        return self._with("objects", name, object)

    def with_obstacle(self, name: str, body: Body) -> Self:
        """Return the scene with an obstacle more, or with another one of a name.

        Args:
            name: of the obstacle.
            body: as it is from now on.

        Raises:
            InputError: an object has this name, or it is no body.
        """
        return self._with("obstacles", name, body)

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

    def changed(self, **fields: Any) -> Self:
        """Return the scene with some fields replaced, validated as a file is.

        Raises:
            InputError: a field is unknown, or a value is wrong; the message names the key.
        """
        content = {name: value for name, value in self.fields().items() if name not in INTERNAL}
        return self._made({**content, **fields})

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy; with some fields changed as `changed` returns it."""
        return self.changed(**update) if update else super().model_copy(deep=deep)

    def bodies_besides(self, task: Task) -> dict[str, Body]:
        """Return what the robot must keep clear of in this task: obstacles and the other objects."""
        others = {name: body for name, body in self.objects.items() if name != task.object}
        return {**self.obstacles, **others}

    def _with(self, table: str, name: str, part: object) -> Self:
        require_kind("name", name, str)
        return self.changed(**{table: {**getattr(self, table), name: part}})

    @classmethod
    def _made(cls, content: Mapping[str, Any]) -> Self:
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            raise input_error(error, cls, content) from None

    def _require(self, what: str, name: str, known: Mapping[str, Any]) -> None:
        if not isinstance(name, str) or name not in known:
            remedy = close_names(name, known)
            raise UnknownNameError(f"no {what} {name!r} in this scene", file=self.source, key=f"{what}s", remedy=remedy)


def load_scene(name: str | Path) -> Scene:
    """Read a scene file, given by path or by the name of a shipped scene.

    Raises:
        FileError: the file is missing, cannot be read or is not YAML.
        InputError: a key or value is wrong; the message names file, line and key.
    """
    file = locate.scene_file(name)
    from .files import read_file  # YAML, which those of a result do not need

    return read_file(file, Scene)


def _in_brackets(numbers: Iterable[float]) -> str:
    return "(" + ", ".join(f"{number:g}" for number in numbers) + ")"


def _shown(shape: ShapeDescription) -> str:
    sizes = shape.model_dump(exclude={"type"}).items()
    shown = [f"{key} {_in_brackets(size) if isinstance(size, tuple) else f'{size:g}'}" for key, size in sizes]
    return ", ".join([shape.type, *shown])
