"""The contacts of a posture that the user gives, as a plan would choose them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..arrays import Array
from ..kinematics.contacts import contact_kinematics
from ..kinematics.forward import forward
from ..problem import CONSTRAINTS, Constraint, DesiredPoints, Evaluation, GraspProblem, State, TaskModel
from ..problem.constraint import PER_METRE
from ..problem.constraints.approach import approach
from ..problem.constraints.clearance import Clearance
from ..problem.constraints.joint_limits import joint_limits
from ..problem.constraints.object_clearance import object_clearance
from ..solve.backends import backend_of
from ..solve.local import limits
from ..solve.options import SolverOptions
from ..solve.projection import nearest_assignment
from ..solve.recorder import Recorder, program_from

STEPS = 20
TOWARDS_DESIRED = 1e-3
"""Weight of the desired points, which decide where a contact is that could be anywhere along a line.

If the task has none, it is as near to the middle of its pad as it can.
"""
OF_POSTURES: Sequence[Callable[[TaskModel], Constraint | None]] = (approach, joint_limits, Clearance, object_clearance)
"""Constraints that are the same wherever contacts are."""
ALL_BUT_PARALLEL = 0.01
"""Angle between faces up to which a contact may go along them, rad."""
ROUNDED = 10.0
"""Scaled violation up to which a posture keeps the constraints, in parts of the solver's tolerance: as of a solve."""
EVALUATIONS = 60
"""Of the search for contacts whose forces are within their limits, at most."""


def touching(model: TaskModel, posture: Array) -> State:
    """Return the state of a posture with contacts where pads and object touch, or are nearest to it.

    Where the posture leaves room, contacts are nearest to what the task desires, or to the middle of the pads. If they
    cannot be there with forces within friction and force limits, they are where a plan would have them: where U is
    least of all places of the pads at which everything holds, if there is one.

    Args:
        model: the task.
        posture: (q_a, sigma), rad (m), shape (l + s,).
    """
    state, problem = _nearest(model, posture)
    chosen, options = _Contacts(model, problem.assignment, state), SolverOptions()
    recorder = Recorder(chosen, ROUNDED * options.tolerance)
    x = np.clip(state.x, chosen.lower, chosen.upper)
    if recorder.at(x).violation <= recorder.tolerance or not chosen.free.any():
        return state
    backend = backend_of(options.algorithm)
    backend.solve(program_from(recorder, x), limits(options, EVALUATIONS, 1.0))
    return problem.state(recorder.best.x) if recorder.best is not None and recorder.feasible else state


class _Contacts(GraspProblem):
    """The problem of where contacts are, at the posture of a state."""

    def __init__(self, model: TaskModel, assignment: tuple[int, ...], state: State) -> None:
        asked = [make for make in CONSTRAINTS if make not in OF_POSTURES]
        super().__init__(model, assignment, asked, desired=_desired(model, state.x))
        own = slice(model.robot.posture_size)
        self.lower[own] = self.upper[own] = state.x[own]
        self.free = self.lower < self.upper

    def equality_basis(self, near: Evaluation) -> Array:
        """Return combinations of the equalities that contacts can do something about.

        A gap between faces that are all but parallel changes so little that contacts would go far for its rounding.
        """
        rows, sizes, _ = np.linalg.svd(near.equalities.jacobian[:, self.free], full_matrices=False)
        return np.asarray(rows[:, sizes > ALL_BUT_PARALLEL * PER_METRE].T)


def _nearest(model: TaskModel, posture: Array) -> tuple[State, GraspProblem]:
    """Return the state of a posture with contacts where pads and object are nearest to touching, and its problem."""
    # The whole pads: whether contacts keep a reserve from the rims is for the check to say.
    size, (low, high) = model.robot.posture_size, model.robot.parameter_limits.T
    x = np.concatenate([posture, 0.5 * (low + high)])
    desired = _desired(model, x)
    problem = GraspProblem(model, tuple(range(len(model.robot.pads))), desired=desired)
    problem = GraspProblem(model, nearest_assignment(model, problem.state(x), desired), desired=desired)
    for _ in range(STEPS):
        residual = problem.projection_residual(x, TOWARDS_DESIRED, 0.0)
        J = residual.jacobian[:, size:]
        step = np.linalg.lstsq(J, -residual.values, rcond=1e-9)[0]
        moved = np.clip(x[size:] + step, low, high)
        done = np.abs(moved - x[size:]).max() < 1e-12
        x = np.concatenate([posture, moved])
        if done:
            break
    return problem.state(x), problem


def _desired(model: TaskModel, x: Array) -> DesiredPoints | None:
    """Return the points of the object nearest to contacts at x, shape (v,), where the task desires none itself."""
    if model.task.desired_contacts is not None:
        return None
    robot, size = model.robot, model.robot.posture_size
    points = contact_kinematics(forward(robot, robot.model.createData(), x[:size]), x[size:]).points
    distances, normals, _ = model.object_surface(points)
    return DesiredPoints(points - distances[:, None] * normals, np.zeros_like(points))
