"""One local solve, and what became of it: the best point that was evaluated, judged by its own violations."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain, islice

import numpy as np

from ..arrays import Array
from ..kinematics.wrist import wrist_pose
from ..problem import DesiredPoints, GraspProblem, Proposal, State, TaskModel, Violation
from ..solver_words import Outcome
from .backends import Limits, Stop, backend_of
from .held_hand import brought, turned
from .options import SolverOptions
from .polish import polished
from .projection import descend, initial_guesses, nearest_assignment
from .recorder import Recorder, program_from

NEAR = 0.02
"""Norm of the scaled residual up to which a projected start is solved from before it is projected onto other pairs."""
HOLDS = 2
GUESSES = 8
"""Points that a start with several pairs is projected to, at most."""


@dataclass(frozen=True)
class Solution:
    """The best point that one start led to."""

    start: int
    outcome: Outcome
    assignment: tuple[int, ...]
    x: Array
    violations: tuple[Violation, ...]
    """Of all constraints; empty where the solver failed."""
    evaluations: int
    seconds: float
    message: str = ""
    state: State | None = field(default=None, repr=False, compare=False)
    """At x, as long as the solver's problem is evaluated nowhere else; None where the solver failed."""

    @property
    def feasible(self) -> bool:
        """Whether the constraints hold to the solver's tolerance."""
        return self.outcome in {"converged", "feasible"}

    @property
    def worst(self) -> Violation | None:
        """The violation that weighs most; None where the solver failed."""
        return max(self.violations, key=lambda violation: violation.size, default=None)


class LocalSolver:
    """Solves a task from one start after another; what one start gives does not depend on the others."""

    def __init__(self, model: TaskModel, options: SolverOptions) -> None:
        self._model = model
        self._options = options
        self._backend = backend_of(options.algorithm)
        self._problems: dict[tuple[tuple[int, ...], bytes], GraspProblem] = {}

    def problem(self, assignment: tuple[int, ...], desired: DesiredPoints | None = None) -> GraspProblem:
        """Return the problem in which pad i serves desired point assignment[i].

        Args:
            assignment: desired point of every pad.
            desired: points that are proposed; None: those that the task desires.
        """
        key = assignment, b"" if desired is None else desired.points.tobytes()
        if key not in self._problems:
            self._problems[key] = GraspProblem(self._model, assignment, desired=desired)
        return self._problems[key]

    def solve(self, index: int, start: Array, proposed: Sequence[Proposal] = ()) -> Solution:
        """Solve from one start.

        Args:
            index: number of the start.
            start: posture (q_a, sigma), shape (l + s,).
            proposed: pairs that are proposed to it, one after the other: where those before lead nowhere; none: it
                has those that the task desires.
        """
        began = time.perf_counter()
        first = self.problem(tuple(range(len(self._model.robot.pads))), proposed[0].desired if proposed else None)
        centers = 0.5 * (first.lower + first.upper)[self._model.robot.posture_size :]
        x = np.clip(np.concatenate([start, centers]), first.lower, first.upper)
        runs = []
        start = first.state(x)
        guesses = self._guesses(start, [pair.desired for pair in proposed] or (None,))
        guesses = chain(self._held_guesses(start, proposed), guesses if len(proposed) < 2 else _nearest_first(guesses))
        for problem, guess in islice(guesses, self._options.tries):
            recorder = Recorder(problem, self._options.tolerance)
            stop = self._backend.solve(program_from(recorder, guess), limits(self._options))
            runs.append((recorder, stop))
            if recorder.feasible:
                break
        count = sum(recorder.evaluations for recorder, _ in runs)
        recorder, stop = min(runs, key=lambda run: run[0].merit)
        return solution_of(index, x, recorder, stop, count, began)

    def _held_guesses(self, start: State, proposed: Sequence[Proposal]) -> Iterator[tuple[GraspProblem, Array]]:
        """Yield problems with points to solve from, at which the hand holds a pair as it did in its trial."""
        here = wrist_pose(start.configuration)
        for pair in proposed:
            for hold in sorted(pair.holds, key=lambda hold: turned(here, hold))[:HOLDS]:
                problem = self.problem(hold.assignment, pair.desired)
                x = brought(problem, start.x, hold)
                if x is None:
                    continue
                guess = descend(problem, 0.0, 1.0, x, 0.0)
                if np.linalg.norm(problem.projection_residual(guess, 0.0, 1.0).values) <= NEAR:
                    yield problem, guess

    def _guesses(self, start: State, desired: Sequence[DesiredPoints | None]) -> Iterator[tuple[GraspProblem, Array]]:
        """Yield problems with points to solve from: the first guess for all desired points, then the second ones."""
        assignments = [nearest_assignment(self._model, start, points) for points in desired]
        problems = [self.problem(*pair) for pair in zip(assignments, desired, strict=True)]
        ways = [(problem, initial_guesses(problem, start.x, self._options.projection)) for problem in problems]
        while ways:  # each guess is made when it is asked for
            for way in list(ways):
                problem, guesses = way
                guess = next(guesses, None)
                if guess is None:
                    ways.remove(way)
                else:
                    yield problem, guess


def _nearest_first(guesses: Iterator[tuple[GraspProblem, Array]]) -> Iterator[tuple[GraspProblem, Array]]:
    """Yield guesses that all but keep the conditions of the projection as they come, then the others, nearest first.

    From nine of ten of the former a solve leads to a grasp; from one of ten of the latter, and it takes four times as
    long.
    """
    others = []
    for problem, guess in islice(guesses, GUESSES):
        miss = float(np.linalg.norm(problem.projection_residual(guess, 0.0, 1.0).values))
        if miss <= NEAR:
            yield problem, guess
        else:
            others.append((miss, problem, guess))
    for _, problem, guess in sorted(others, key=lambda other: other[0]):
        yield problem, guess


def solution_of(index: int, x: Array, recorder: Recorder, stop: Stop, evaluations: int, began: float) -> Solution:
    """Return the outcome of a start.

    Args:
        index: number of the start.
        x: where it began, shape (v,).
        recorder: of the solve that came furthest.
        stop: its end.
        evaluations: of all solves.
        began: time when the start was begun, by `time.perf_counter`.
    """
    problem, best = recorder.problem, recorder.best
    assignment = problem.assignment
    if best is None:
        return Solution(index, "failed", assignment, x, (), evaluations, time.perf_counter() - began, stop.message)
    best = polished(problem, best, recorder.tolerance) if recorder.feasible else best
    state = problem.state(best.x)
    violations = problem.violations(state)
    seconds = time.perf_counter() - began
    outcome = _outcome(stop, recorder.feasible)
    return Solution(index, outcome, assignment, best.x, violations, evaluations, seconds, stop.message, state)


def limits(options: SolverOptions) -> Limits:
    """Return when a solve may stop."""
    return Limits(
        evaluations=options.budget,
        violation=10.0 * options.tolerance,  # the last digits are polished
        cost_change=options.cost_tolerance,
        relative_cost_change=10.0 * options.cost_tolerance,
    )


def _outcome(stop: Stop, feasible: bool) -> Outcome:
    if feasible:
        return "converged" if stop.reason == "converged" else "feasible"
    if stop.reason == "budget spent":
        return "budget spent"
    return "failed" if stop.reason == "failed" else "infeasible"
