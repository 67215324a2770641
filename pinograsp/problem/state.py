"""Everything that one point x determines, each part computed once and only if asked for."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array
from ..descriptions import SceneDescription, TaskDescription, robot_for
from ..descriptions.robot import SoftFinger
from ..mechanics import (
    ContactDerivatives,
    ContactModels,
    Contacts,
    ForceLimits,
    ForceSolution,
    Hand,
    Load,
    Statics,
    grasp_statics,
    solve_forces,
)
from ..models import (
    CollisionModel,
    Configuration,
    ContactKinematics,
    Distances,
    RobotModel,
    contact_kinematics,
    forward,
    jacobian_derivatives,
    membership,
    surface_of,
)
from .preferences import approach_cone, posture_bounds


class TaskModel:
    """What stays the same over all points of a task: robot, geometry, load, limits."""

    def __init__(self, robot: RobotModel, scene: SceneDescription, task_name: str) -> None:
        self.scene, self.task_name = scene, task_name
        self.task: TaskDescription = scene.task(task_name)
        self.robot = RobotModel(robot_for(robot.description, scene, task_name), scene.mounting.matrix)
        self.lower, self.upper = posture_bounds(self.robot, scene, task_name)
        self.collisions = CollisionModel(self.robot, scene, self.task)
        target = scene.objects[self.task.object]
        self.surface = surface_of(target.shape)
        self.T_world_object = target.pose.matrix
        desired = np.array(self.task.desired_contacts)
        self.desired_points = desired @ self.T_world_object[:3, :3].T + self.T_world_object[:3, 3]
        region = self.task.contact_region
        self.region = None if region is None else membership(region)
        self.approach = approach_cone(self.task, self.T_world_object)
        self.load = Load(target.center_of_mass_world, self.task.wrench.vector, self.surface.radius)
        stiffness = robot.description.stiffness
        hand_size = len(self.robot.hand_joints)
        self.hand = Hand(self.robot.synergies, np.full(hand_size, 1.0 / stiffness.joint))
        self.contact_models = _contact_models(self.robot)
        constants = self.task.contact
        self.limits = ForceLimits(constants.friction, constants.min_normal_force, constants.max_force, constants.kappa)

    def object_surface(self, points: Array) -> tuple[Array, Array, Array]:
        """Return signed distance, outward normal and Hessian at world points; shapes (n,), (n, 3), (n, 3, 3)."""
        R, origin = self.T_world_object[:3, :3], self.T_world_object[:3, 3]
        distances, normals, hessians = self.surface.signed_distance((points - origin) @ R)
        return distances, normals @ R.T, R @ hessians @ R.T


def _contact_models(robot: RobotModel) -> ContactModels:
    stiffness = robot.description.stiffness.contact
    radius: list[float] = []
    compliance: list[float] = []
    for pad in robot.description.pads:
        soft = pad.contact if isinstance(pad.contact, SoftFinger) else None
        radius.append(soft.torsion_radius if soft else 0.0)
        compliance += 3 * [1.0 / stiffness]
        if soft:
            compliance.append(1.0 / soft.torsional_stiffness)
    return ContactModels(np.array(radius), np.array(compliance))


class State:
    """A point x = (q_a, sigma, q_c) of a task, with pad i serving desired point assignment[i]."""

    def __init__(self, model: TaskModel, data: Any, x: Array, assignment: tuple[int, ...]) -> None:
        self.model = model
        self.x = x
        self._desired = model.desired_points[list(assignment)]
        size = model.robot.posture_size
        self.configuration: Configuration = forward(model.robot, data, x[:size])
        self.contacts: ContactKinematics = contact_kinematics(self.configuration, x[size:])

    @property
    def desired(self) -> Array:
        """Desired point of every pad, world, m, shape (n, 3)."""
        return self._desired

    @cached_property
    def surface(self) -> tuple[Array, Array, Array]:
        """Signed distance, outward normal and Hessian of the object at the contact points."""
        return self.model.object_surface(self.contacts.points)

    @cached_property
    def distances(self) -> Distances:
        """Signed distances of the pairs of bodies."""
        return self.model.collisions.distances(self.configuration)

    @cached_property
    def grasp(self) -> Contacts:
        """The contacts as the statics see them."""
        return Contacts(self.contacts.points, self.contacts.normals, self.contacts.jacobians)

    @cached_property
    def grasp_derivatives(self) -> ContactDerivatives:
        """Derivatives of `grasp` in x."""
        jacobians = jacobian_derivatives(self.model.robot, self.contacts)
        return ContactDerivatives(self.contacts.d_points, self.contacts.d_normals, jacobians)

    @cached_property
    def statics(self) -> Statics:
        """Matrices of the grasp."""
        return grasp_statics(self.grasp, self.model.contact_models, self.model.hand, self.model.load)

    @cached_property
    def forces(self) -> ForceSolution:
        """Best contact forces (8)."""
        return solve_forces(self.statics, self.contacts.normals, self.model.contact_models, self.model.limits)
