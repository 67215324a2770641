"""One local solve, and what became of it: the best point that was evaluated, judged by its own violations."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..problem import DesiredPoints, GraspProblem, Proposal, State, TaskModel, Violation
from ..solver_words import Outcome
from .backends import Limits, Stop, backend_of
from .guesses import Guess, held_guesses, nearest_first
from .options import SolverOptions
from .polish import polished
from .projection import initial_guesses, nearest_assignment
from .recorder import Recorder, program_from

SHORT = 0.25
"""Part of the budget that each solve of a start with several pairs has; most that lead to a grasp need a tenth.

If none of them does, the one that came furthest goes on with the rest.
"""
PROPOSED = 10.0
"""Tolerance of the cost where contacts are proposed, in parts of the one of the options, which is for Phi: 0.01 in U.
Without Phi the cost is some tenths, and most of that is tilt within what the rubber evens out.
"""


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
        guesses = self._guesses(first.state(x), proposed)
        most = self._options.budget if len(proposed) < 2 else math.ceil(SHORT * self._options.budget)
        within = limits(self._options, most, PROPOSED if proposed else 1.0)
        runs: list[Run] = []
        for problem, guess in islice(guesses, self._options.tries):
            runs.append(self._run(problem, guess, within))
            if runs[-1].recorder.feasible:
                break
        best = min(runs, key=lambda run: run.recorder.merit)
        if most < self._options.budget and not best.recorder.feasible and best.recorder.best is not None:
            rest = replace(within, evaluations=self._options.budget - most)
            runs.append(self._run(best.recorder.problem, best.recorder.best.x, rest))
            best = min(runs, key=lambda run: run.recorder.merit)
        count = sum(run.recorder.evaluations for run in runs)
        return solution_of(index, x, best.recorder, best.stop, count, began)

    def _guesses(self, start: State, proposed: Sequence[Proposal]) -> Iterator[Guess]:
        """Yield problems with points to solve from: if pairs are proposed, first those at which hands hold one."""
        if not proposed:
            problem = self.problem(nearest_assignment(self._model, start))
            return ((problem, x) for x in initial_guesses(problem, start.x, self._options.projection))
        onto = self._options.projection
        held = held_guesses(self.problem, start, proposed) if onto == "contacts and clearance" else ()
        return chain(held, nearest_first(self.problem, start, proposed, onto))

    def _run(self, problem: GraspProblem, guess: Array, within: Limits) -> Run:
        """Solve a problem from a point, shape (v,)."""
        recorder = Recorder(problem, self._options.tolerance)
        return Run(recorder, self._backend.solve(program_from(recorder, guess), within))


class Run(NamedTuple):
    """A solve from one point."""

    recorder: Recorder
    stop: Stop


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


def limits(options: SolverOptions, evaluations: int, loose: float) -> Limits:
    """Return when a solve with so many evaluations at most, and so many times the tolerance of the cost, may stop."""
    return Limits(
        evaluations=evaluations,
        violation=10.0 * options.tolerance,  # the last digits are polished
        cost_change=loose * options.cost_tolerance,
        relative_cost_change=10.0 * loose * options.cost_tolerance,
    )


def _outcome(stop: Stop, feasible: bool) -> Outcome:
    if feasible:
        return "converged" if stop.reason == "converged" else "feasible"
    if stop.reason == "budget spent":
        return "budget spent"
    return "failed" if stop.reason == "failed" else "infeasible"
