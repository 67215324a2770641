"""One start: solved, checked, and a grasp if the check verifies it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from ..arrays import Array
from ..descriptions.mesh_keys import mesh_keys
from ..descriptions.robot_files import hashes_of, require_same
from ..kinematics.robot import Robot
from ..memo import remembered
from ..problem import Proposal, State, TaskModel
from ..problem.contact_pairs import Candidate, proposal
from ..results import Grasp
from ..solve.local import Solution
from ..verification import Certificate
from ..verification.check import Verifier
from ..verification.robot import read_robot
from .assemble import claim_of, exact, grasp_of

TRIED = 3
"""Pairs of contacts that are proposed to a start, one after the other."""


@dataclass(frozen=True)
class Item:
    """One start of a plan."""

    index: int
    """Its number."""
    posture: Array
    """(q_a, sigma), rad (m), shape (l + s,)."""
    proposed: tuple[Proposal, ...] = ()
    """Pairs that are proposed to it, one after the other; none of a task that desires some."""


def items_of(model: TaskModel, postures: Array, candidates: Sequence[Candidate]) -> list[Item]:
    """Return the starts of a plan.

    Each is led to a pair of its own, one after the other, and where that leads nowhere to others that are far from it.
    The hand is as far open as the first of them needs.

    Args:
        model: the task.
        postures: (q_a, sigma), rad (m), shape (n, l + s).
        candidates: pairs that are proposed; none for a task that desires some points.
    """
    if not candidates:
        return [Item(index, posture) for index, posture in enumerate(postures)]
    items, pairs = [], [proposal(candidate, model) for candidate in candidates]
    steps = sorted({len(pairs) * k // TRIED for k in range(TRIED)})
    for index, posture in enumerate(postures):
        own = [(index + step) % len(pairs) for step in steps]
        items.append(Item(index, opened(model, posture, candidates[own[0]]), tuple(pairs[k] for k in own)))
    return items


def opened(model: TaskModel, posture: Array, candidate: Candidate) -> Array:
    """Return a posture with the hand as far open as a pair needs."""
    size = model.robot.arm_size
    return np.concatenate([posture[:size], np.clip(candidate.holds.synergies, model.lower[size:], model.upper[size:])])


class Solver(Protocol):
    """Solves a task from one start after another, such as `solve.LocalSolver`."""

    def solve(self, index: int, start: Array, proposed: Sequence[Proposal]) -> Solution:
        """Return where the start of a number, posture (q_a, sigma) of shape (l + s,), leads.

        Pairs that are proposed to it are tried one after the other; without any it has those that the task desires.
        """


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


def attempt(solver: Solver, verifier: Verifier, item: Item) -> Attempt:
    """Solve from one start and judge what comes of it.

    Args:
        solver: of the task.
        verifier: of the same task.
        item: the start.
    """
    solution = solver.solve(item.index, item.posture, item.proposed)
    alone = replace(solution, state=None)
    if solution.state is None or not solution.feasible:
        return Attempt(alone)
    began = time.perf_counter()
    certificate, grasp = certify(item.index, solution.state, verifier)
    return Attempt(alone, certificate, grasp, time.perf_counter() - began)


def certify(index: int, state: State, verifier: Verifier) -> tuple[Certificate, Grasp | None]:
    """Return the certificate of a state that the start of a number led to, and the grasp if it is verified."""
    claim = claim_of(state)
    certificate = verifier.check(claim)
    if not certificate.verified:
        return certificate, None
    return certificate, exact(grasp_of(index, state, claim, certificate), state.model, verifier)


def attempts_of(model: TaskModel, solver_of: Callable[[TaskModel], Solver]) -> Callable[[Item], Attempt]:
    """Build, in a worker, the handler of starts."""
    solver, verifier = solver_of(model), verifier_of(model)
    return lambda item: attempt(solver, verifier, item)


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
    with mesh_keys(model.scene):
        return Verifier(model.robot.unmounted.description, model.scene, model.task_name)


def lost_attempt(item: Item, reason: str) -> Attempt:
    """Return the attempt of a start whose worker ended twice."""
    message = f"start {item.index} lost: {reason}"
    return Attempt(Solution(item.index, "failed", (), item.posture, (), 0, 0.0, message))
