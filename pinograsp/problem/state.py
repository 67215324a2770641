"""Everything that one point x determines, each part computed once and only if asked for."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array
from ..collision.distances import Distances
from ..geometry.contact_faces import ContactFace
from ..kinematics.contacts import ContactKinematics, contact_kinematics, jacobian_derivatives
from ..kinematics.forward import Configuration, forward
from ..mechanics import (
    ContactDerivatives,
    Contacts,
    ForceSolution,
    Statics,
    force_cost_gradient,
    grasp_statics,
    solve_forces,
)
from .desired import DesiredPoints
from .task_model import TaskModel


class State:
    """A point x = (q_a, sigma, q_c) of a task.

    Args:
        model: the task.
        data: a Pinocchio Data of its robot's model, used as scratch space.
        x: the point, shape (v,).
        desired: where the contact of each pad is wanted.
    """

    def __init__(self, model: TaskModel, data: Any, x: Array, desired: DesiredPoints) -> None:
        self.model = model
        self.x = x
        self._desired = desired
        size = model.robot.posture_size
        self.configuration: Configuration = forward(model.robot, data, x[:size])
        self.contacts: ContactKinematics = contact_kinematics(self.configuration, x[size:])

    @property
    def desired(self) -> Array:
        """Desired point of every pad, world, m, shape (n, 3)."""
        return self._desired.points

    @property
    def desired_normals(self) -> Array:
        """Outward normal of the surface that every pad is to look at; zero if any will do, shape (n, 3)."""
        return self._desired.normals

    @cached_property
    def surface(self) -> tuple[Array, Array, Array]:
        """Signed distance, outward normal and Hessian of the object at the contact points."""
        return self.model.object_surface(self.contacts.points)

    @cached_property
    def footprint(self) -> tuple[Array, Array]:
        """Outward normals of the object at the contact points as pads feel it, (n, 3), and derivatives, (n, 3, 3)."""
        if not self.model.surface.uneven:
            return self.surface[1:]
        return self.model.footprint(self.contacts.points)

    @cached_property
    def contact_faces(self) -> tuple[ContactFace, ...]:
        """Contact face of the object at every contact point, world frame."""
        return tuple(self.model.contact_face(point) for point in self.contacts.points)

    @cached_property
    def touched_parts(self) -> tuple[int, ...]:
        """Part of the object that every contact point is nearest to; 0 but of a compound."""
        return tuple(self.model.touched_parts(self.contacts.points).tolist())

    @cached_property
    def distances(self) -> Distances:
        """Signed distances of the pairs of bodies."""
        return self.model.collisions.distances(self.configuration)

    @cached_property
    def object_distances(self) -> Distances:
        """Distances of `TaskModel.object_points` to an uneven object."""
        return self.model.object_distances(self.configuration)

    @cached_property
    def grasp(self) -> Contacts:
        """The contacts as the statics see them.

        Forces are about the pads' normals, which a smooth surface shares at a grasp, and about those of an uneven one.
        """
        uneven = self.model.surface.uneven
        normals = -self.footprint[0] if uneven else self.contacts.normals
        return Contacts(self.contacts.points, normals, self.contacts.jacobians)

    @cached_property
    def grasp_derivatives(self) -> ContactDerivatives:
        """Derivatives of `grasp` in x."""
        jacobians = jacobian_derivatives(self.model.robot, self.contacts)
        d_points, d_normals = self.contacts.d_points, self.contacts.d_normals
        if self.model.surface.uneven:
            d_normals = -np.matmul(self.footprint[1], d_points)
        return ContactDerivatives(d_points, d_normals, jacobians)

    @cached_property
    def statics(self) -> Statics:
        """Matrices of the grasp."""
        return grasp_statics(self.grasp, self.model.contact_models, self.model.hand, self.model.load)

    @cached_property
    def forces(self) -> ForceSolution:
        """Best contact forces (8)."""
        return solve_forces(self.statics, self.grasp.normals, self.model.contact_models, self.model.limits)

    @cached_property
    def force_gradient(self) -> Array:
        """Gradient of V* in x, shape (v,)."""
        return force_cost_gradient(
            self.statics, self.grasp, self.grasp_derivatives, self.model.contact_models, self.forces
        )
