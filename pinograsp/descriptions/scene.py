"""The scene file: enclosure, mounting of the arm, obstacles, objects and tasks.

World frame as the file's author chooses it; lengths in metres, angles in radians, forces in newtons.
"""

from __future__ import annotations

import math
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field, field_validator, model_validator

from ..arrays import Array
from ..errors import InputError, close_names
from . import locate
from .files import FileRoot, Format1, Frozen, Number, OrderedInterval, UnitVector3, Vector3, read_file, wrong
from .hand import ContactModel
from .pose import ZERO, Pose
from .regions import AllOf, Outside, Region
from .shapes import Shape

Name = Annotated[str, Field(min_length=1)]


def _without_slash(name: str) -> str:
    if "/" in name or "\\" in name:
        raise ValueError("a slash is not allowed: the name becomes part of a file's name")
    return name


FileName = Annotated[Name, AfterValidator(_without_slash)]
Positive = Annotated[Number, Field(gt=0.0)]
NotNegative = Annotated[Number, Field(ge=0.0)]


class Enclosure(Frozen):
    """The inside of a box-shaped room, m, edges along the world axes; its six walls are half-spaces."""

    min: Vector3
    max: Vector3

    @model_validator(mode="after")
    def _ordered(self) -> Enclosure:
        for axis, letter in enumerate("xyz"):
            if self.min[axis] >= self.max[axis]:
                raise wrong(f"min {self.min[axis]:g} is not below max {self.max[axis]:g} along {letter}", "min", axis)
        return self

    @cached_property
    def walls(self) -> dict[str, tuple[Array, float]]:
        """Name to (inward normal n, offset d): the inside is n . p >= d."""
        walls: dict[str, tuple[Array, float]] = {}
        for axis, letter in enumerate("xyz"):
            inward = np.eye(3)[axis]
            walls[f"wall {letter}={self.min[axis]:g}"] = (inward, self.min[axis])
            walls[f"wall {letter}={self.max[axis]:g}"] = (-inward, -self.max[axis])
        return walls


class Body(Frozen):
    """A shape at a pose: an obstacle or an object."""

    shape: Shape
    pose: Pose = Pose()


class Object(Body):
    """Something to grasp; in the tasks of other objects it is an obstacle."""

    center_of_mass: Vector3 = ZERO
    """In the object's frame, m."""
    mass: Positive | None = None
    """kg; by default what a task's external force weighs on Earth."""

    @cached_property
    def center_of_mass_world(self) -> Array:
        """Centre of mass in the world, m, shape (3,)."""
        T = self.pose.matrix
        return np.asarray(T[:3, :3] @ np.array(self.center_of_mass) + T[:3, 3])


class Wrench(Frozen):
    """External wrench on the object: force, N, and torque about the centre of mass, N m, world frame."""

    force: Vector3
    torque: Vector3 = ZERO

    @cached_property
    def vector(self) -> Array:
        """The wrench as (force, torque), shape (6,)."""
        return np.array([*self.force, *self.torque])


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
    """Robot to walls, obstacles and other objects (16)."""
    robot: NotNegative = 0.005
    """Robot to itself."""
    object: NotNegative = 0.001
    """Links that are no pads, and what stands out beside a pad, to the object: only pads are to carry it."""


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
    """Where the hand points, length 1: [0, 0, -1] is from above."""
    angle: Annotated[Number, Field(gt=0.0, le=math.pi)]
    """Half-angle of the cone, rad."""
    frame: Literal["world", "object"] = "world"
    """Frame of `direction`."""


class Task(Frozen):
    """An object to hold: where, against which wrench, with how much room."""

    object: Name
    desired_contacts: Annotated[tuple[Vector3, ...], Field(min_length=2)]
    """Desired contact points on the object's surface, m, in the object's frame; one for each pad."""
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
    joint_ranges: dict[Name, OrderedInterval] = Field(default_factory=dict)
    """Ranges of arm joints and synergies within the robot's limits, rad (m).

    Whole turns of a continuous joint do not count: [3.0, 3.5] holds the reported angle -3.1, which is 3.18 less a turn.
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
            parts.append(Outside(type="outside", part=self.forbidden_contacts))
        return AllOf(type="all_of", parts=tuple(parts)) if len(parts) > 1 else parts[0] if parts else None


class Scene(FileRoot):
    """A scene file."""

    format: Format1
    name: FileName
    description: str = ""
    enclosure: Enclosure
    mounting: Pose = Pose()
    """Pose of the robot's root link in the world."""
    obstacles: dict[Name, Body] = Field(default_factory=dict)
    objects: dict[Name, Object]
    tasks: dict[FileName, Task]

    @model_validator(mode="after")
    def _references(self) -> Scene:
        for name, task in self.tasks.items():
            if task.object not in self.objects:
                remedy = close_names(task.object, list(self.objects))
                raise wrong(f"no object {task.object!r} is defined", "tasks", name, "object", remedy=remedy)
        for name in self.obstacles:
            if name in self.objects:
                raise wrong("an object has the same name", "obstacles", name, remedy="Rename one of them")
        return self

    def task(self, name: str) -> Task:
        """Return a task by name.

        Raises:
            InputError: there is none of this name.
        """
        if name not in self.tasks:
            remedy = close_names(name, list(self.tasks))
            raise InputError(f"no task {name!r} in this scene", file=self.source, key="tasks", remedy=remedy)
        return self.tasks[name]

    def with_object_pose(self, name: str, pose: Pose) -> Scene:
        """Return the scene with an object at another pose.

        Args:
            name: of the object.
            pose: of the object in the world.

        Raises:
            InputError: there is no object of this name.
        """
        if name not in self.objects:
            remedy = close_names(name, list(self.objects))
            raise InputError(f"no object {name!r} in this scene", file=self.source, key="objects", remedy=remedy)
        body = self.objects[name].model_copy(update={"pose": pose})
        return self.changed(objects={**self.objects, name: body})

    def bodies_besides(self, task: Task) -> dict[str, Body]:
        """Return what the robot must keep clear of in this task: obstacles and the other objects."""
        others = {name: body for name, body in self.objects.items() if name != task.object}
        return {**self.obstacles, **others}


def load_scene(name: str | Path) -> Scene:
    """Read a scene file, given by path or by the name of a shipped scene.

    Raises:
        InputError: the file is missing, or a key or value is wrong.
    """
    return read_file(locate.scene_file(name), Scene)
