"""One start: solved, checked, and a grasp if the check verifies it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

from ..arrays import Array
from ..descriptions.robot_files import hashes_of, require_same
from ..kinematics.robot import Robot
from ..memo import remembered
from ..planning.assemble import claim_of, exact, grasp_of
from ..problem import State, TaskModel
from ..results import Grasp
from ..solve.local import Solution
from ..verification import Certificate
from ..verification.check import Verifier
from ..verification.robot import read_robot


class Solver(Protocol):
    """Solves a task from one start after another, such as `solve.LocalSolver`."""

    def solve(self, index: int, start: Array) -> Solution:
        """Return where the start of a number, posture (q_a, sigma) of shape (l + s,), leads."""


@dataclass(frozen=True)
class Attempt:
    """Outcome of one start."""

    solution: Solution
    """Without its state, which belongs to the process that solved."""
    certificate: Certificate | None = None
    """Of a solution that the solver calls feasible."""
    grasp: Grasp | None = None
    """If the certificate verifies it."""
    verify_seconds: float = 0.0


def attempt(solver: Solver, verifier: Verifier, index: int, start: Array) -> Attempt:
    """Solve from one start and judge what comes of it.

    Args:
        solver: of the task.
        verifier: of the same task.
        index: number of the start.
        start: posture (q_a, sigma), shape (l + s,).
    """
    solution = solver.solve(index, start)
    alone = replace(solution, state=None)
    if solution.state is None or not solution.feasible:
        return Attempt(alone)
    began = time.perf_counter()
    certificate, grasp = certify(index, solution.state, verifier)
    return Attempt(alone, certificate, grasp, time.perf_counter() - began)


def certify(index: int, state: State, verifier: Verifier) -> tuple[Certificate, Grasp | None]:
    """Return the certificate of a state that the start of a number led to, and the grasp if it is verified."""
    claim = claim_of(state)
    certificate = verifier.check(claim)
    if not certificate.verified:
        return certificate, None
    return certificate, exact(grasp_of(index, state, claim, certificate), state.model, verifier)


def attempts_of(model: TaskModel, solver_of: Callable[[TaskModel], Solver]) -> Callable[[tuple[int, Array]], Attempt]:
    """Build, in a worker, the handler of starts: number and posture (q_a, sigma) of shape (l + s,)."""
    solver, verifier = solver_of(model), verifier_of(model)
    return lambda item: attempt(solver, verifier, *item)


@remembered
def require_consistent(robot: Robot) -> None:
    """Refuse an unmounted robot whose files have changed since it was loaded; have the verification read them too.

    From then on solver and verification keep what they have read.

    Raises:
        InputError: a file has changed, or the verification cannot read it.
    """
    require_same(robot.description, robot.files, hashes_of(robot.description, robot.urdf.composed))
    read_robot(robot.description)


def verifier_of(model: TaskModel) -> Verifier:
    """Return the verifier of a task, which reads the robot file with all its pads."""
    return Verifier(model.robot.unmounted.description, model.scene, model.task_name)


def lost_attempt(item: tuple[int, Array], reason: str) -> Attempt:
    """Return the attempt of a start whose worker ended twice."""
    index, posture = item
    return Attempt(Solution(index, "failed", (), posture, (), 0, 0.0, f"start {index} lost: {reason}"))
