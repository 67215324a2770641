"""A task as its problem sees it: all that does not depend on Q."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import cast

import numpy as np

from ..arrays import Array, Indices
from ..collision.distances import CollisionModel, Distances
from ..collision.object_points import ObjectPoints, object_points
from ..collision.scene_world import MARGIN_EXCESS, task_world
from ..collision.world import BodyKey, Role
from ..descriptions import Scene, Task, robot_for
from ..descriptions.hand import PadDescription, SoftFinger
from ..geometry.contact_faces import ContactFace, Flat, placed
from ..geometry.filled import center_of_mass, center_of_mass_world
from ..geometry.regions import membership
from ..geometry.shapes import UnevenSurface, surface_of
from ..kinematics.forward import Configuration
from ..kinematics.robot import Robot
from ..mechanics import ContactModels, ForceLimits, Hand, Load
from .desired import DesiredPoints
from .preferences import approach_cone, parameter_limits, posture_bounds


class TaskModel:
    """All of a task that does not depend on Q: robot, geometry, load, limits."""

    def __init__(self, robot: Robot, scene: Scene, task_name: str) -> None:
        self.scene, self.task_name = scene, task_name
        self.task: Task = scene.task(task_name)
        pads = robot_for(robot.description, scene, task_name).pads
        self.robot = robot.with_pads(tuple(pad.name for pad in pads)).mounted(scene.mounting.matrix)
        self.lower, self.upper = posture_bounds(self.robot, scene, task_name)
        self.parameter_limits = parameter_limits(self.robot, scene, task_name)
        self.collisions = CollisionModel(self.robot, task_world(self.robot, scene, self.task))
        target = scene.objects[self.task.object]
        self.surface = surface_of(target.shape)
        self._size = self.surface.radius_about(center_of_mass(target))
        region = scene.region_of(self.task)
        self.region = None if region is None else membership(region)
        self._place_object()
        stiffness = robot.description.stiffness
        hand_size = len(self.robot.hand_joints)
        self.hand = Hand(self.robot.synergies, np.full(hand_size, 1.0 / stiffness.joint))
        self.contact_models = _contact_models(pads, stiffness.contact)
        constants = self.task.contact
        self.limits = ForceLimits(constants.friction, constants.min_normal_force, constants.max_force, constants.kappa)

    def __reduce__(self) -> tuple[object, ...]:
        """Build again from robot, scene and task: Coal's and Pinocchio's objects do not travel."""
        return (TaskModel, (self.robot.unmounted, self.scene, self.task_name))

    def _place_object(self) -> None:
        target = self.scene.objects[self.task.object]
        self.T_world_object = target.pose.matrix
        self.desired_points, self.desired_normals = self.desired(np.array(self.task.desired_contacts or ()))
        """As `DesiredPoints` has them; shape (0, 3) of a task that leaves them out."""
        self.approach = approach_cone(self.task, self.T_world_object)
        self.load = Load(center_of_mass_world(target), self.scene.wrench_of(self.task).vector, self._size)

    def moved(self, name: str, scene: Scene) -> TaskModel:
        """Return the model after an object has moved; nothing is rebuilt.

        Args:
            name: of the object, the task's own or another one.
            scene: the scene, which differs from this one's in the pose of that object alone.
        """
        model = object.__new__(TaskModel)
        model.__dict__.update(self.__dict__)
        model.scene = scene
        role: Role = "target" if name == self.task.object else "obstacle"
        if role == "obstacle" or not self.surface.uneven:
            model.collisions = self.collisions.moved(BodyKey(role, name), scene.objects[name].pose.matrix)
        model._place_object()
        return model

    def desired(self, points: Array) -> DesiredPoints:
        """Return points of the surface, in the object's frame, m, shape (n, 3), as places where contact is wanted."""
        points = points.reshape(-1, 3) @ self.T_world_object[:3, :3].T + self.T_world_object[:3, 3]
        if self.surface.uneven:
            return DesiredPoints(points, self.footprint(points)[0])
        faces = [self.contact_face(point) for point in points]
        normals = [face.normal if isinstance(face, Flat) else np.zeros(3) for face in faces]
        return DesiredPoints(points, np.array(normals).reshape(-1, 3))

    def object_surface(self, points: Array) -> tuple[Array, Array, Array]:
        """Return signed distance, outward normal and Hessian at world points; shapes (n,), (n, 3), (n, 3, 3)."""
        R, origin = self.T_world_object[:3, :3], self.T_world_object[:3, 3]
        distances, normals, hessians = self.surface.signed_distance((points - origin) @ R)
        return distances, normals @ R.T, R @ hessians @ R.T

    def exact_distances(self, points: Array) -> Array:
        """Return the signed distances of world points, shape (n, 3), to the object, not interpolated, m, shape (n,)."""
        R, origin = self.T_world_object[:3, :3], self.T_world_object[:3, 3]
        return self.surface.exact_distances((points - origin) @ R)

    def footprint(self, points: Array) -> tuple[Array, Array]:
        """Return the outward normals that a pad feels at world points, and derivatives; shapes (n, 3), (n, 3, 3)."""
        R, origin = self.T_world_object[:3, :3], self.T_world_object[:3, 3]
        normals, derivatives = self.surface.footprint((points - origin) @ R)
        return normals @ R.T, R @ derivatives @ R.T

    def felt_normals(self, points: Array) -> Array:
        """Return the outward normals of the object as a pad feels them at world points, shape (n, 3)."""
        return self.footprint(points)[0] if self.surface.uneven else self.object_surface(points)[1]

    @cached_property
    def object_points(self) -> ObjectPoints:
        """The points by which the robot is kept off an uneven object."""
        return object_points(self.robot, self.task.margin.object + MARGIN_EXCESS)

    def object_distances(self, configuration: Configuration) -> Distances:
        """Return the distances of `object_points` to the object, which is uneven."""
        return self.object_points.distances(configuration, cast(UnevenSurface, self.surface), self.T_world_object)

    def touched_parts(self, points: Array) -> Indices:
        """Return the part of the object that each world point is nearest to; 0 but of a compound."""
        R, origin = self.T_world_object[:3, :3], self.T_world_object[:3, 3]
        return self.surface.nearest_part((points - origin) @ R)

    def contact_face(self, point: Array) -> ContactFace:
        """Return the contact face of the object at its surface point nearest to a world point; world frame."""
        R, origin = self.T_world_object[:3, :3], self.T_world_object[:3, 3]
        return placed(self.surface.contact_face((point - origin) @ R), R, origin)


def _contact_models(pads: Sequence[PadDescription], stiffness: float) -> ContactModels:
    radius: list[float] = []
    compliance: list[float] = []
    for pad in pads:
        soft = pad.contact if isinstance(pad.contact, SoftFinger) else None
        radius.append(soft.torsion_radius if soft else 0.0)
        compliance += 3 * [1.0 / stiffness]
        if soft:
            compliance.append(1.0 / soft.torsional_stiffness)
    return ContactModels(np.array(radius), np.array(compliance))
