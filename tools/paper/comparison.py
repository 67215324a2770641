"""LD_SLSQP with exact gradients against LN_COBYLA, the paper's solver, on the same starts.

(a) Each with its own budget. (b) At equal time: NLopt gets no time limit here, so LN_COBYLA gets as many evaluations
as fit into LD_SLSQP's mean time a start, once at what an evaluation costs here, once at what one without gradients
would cost, which LN_COBYLA does not need. Both from projected starts, as the planner solves, and from the starts as the
database gives them, as the paper did.
"""

from __future__ import annotations

import time
from functools import partial
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

import pinograsp
from pinograsp.problem import GraspProblem, TaskModel
from pinograsp.solve.local import LocalSolver
from pinograsp.solve.options import Projection, SolverOptions

from .attempts import Attempt, as_data, attempt_all, attempts_table, by_options, of_data, postures_of
from .cases import Case
from .page import Block, Heading, Text
from .runs import Session
from .store import key_of

PRICED = 20
"""Starts at whose solutions evaluations are timed."""
KINDS: dict[str, Projection] = {"projected": "contacts and clearance", "raw": "nothing"}
OWN, EQUAL, CHEAPER = "own budget", "time of LD_SLSQP", "time of LD_SLSQP, no gradients"
HEAD = ("starts", "solver", "evaluations allowed", "given")
Row = tuple[str, str, str, str]


def comparison_section(session: Session, starts: int) -> list[Block]:
    """Compare on every case and robot, and return the section."""
    blocks: list[Block] = [
        Heading(2, "Solvers"),
        Text(
            f"The same {starts} starts for LD_SLSQP (the default, exact gradients) and LN_COBYLA (the paper's, without "
            "gradients), projected on contacts and clearances first, as the planner does it, and raw, as the database "
            "gives them and the paper solved them. Each has its own budget, until it converges or the budget is spent; "
            "then LN_COBYLA has the mean time that LD_SLSQP took. The solver knows no time limit, so the time is "
            "turned into a number of evaluations. A projected start that fails is begun a second time with the same "
            "budget; the measured time is in the table. Near the best: share of all starts, within 1 % + 1 mm² of the "
            "best U of all rows. The best point that was evaluated counts, so the rows with one evaluation are what "
            "the start alone is worth. Every evaluation yields gradients, which LN_COBYLA does not use; rows without "
            "gradients give it as many evaluations as would fit if they were not computed. The planner's equalities "
            "are chosen for points near contact, which raw starts are not."
        ),
    ]
    for case in session.cases:
        for robot in session.robots:
            scene = pinograsp.load_scene(case.scene)
            options = [
                _options(algorithm, "contacts and clearance").to_json() for algorithm in ("LD_SLSQP", "LN_COBYLA")
            ]
            key = key_of(robot, scene, case.task, starts=starts, seed=session.seed, solvers=options)
            name = f"{robot.description.name}-{case.name}-solvers"
            data = session.store.data(name, key, partial(compare, session, robot, case, starts))
            price = data["price"]
            table = {tuple(row["row"]): of_data(row["attempts"]) for row in data["rows"]}
            blocks += [
                Heading(3, f"{case.title}, {robot.description.name}"),
                attempts_table(table, HEAD),
                Text(
                    f"An evaluation takes {1e3 * price['evaluate']:.2f} ms, without the gradients of forces and "
                    f"constraints {1e3 * price['values']:.2f} ms (this still contains those of contact points and "
                    "distances, which cost little)."
                ),
            ]
    return blocks


def _options(algorithm: str, projection: Projection, budget: int | None = None) -> SolverOptions:
    return SolverOptions(algorithm=algorithm, projection=projection, max_evaluations=budget)


def compare(session: Session, robot: pinograsp.Robot, case: Case, starts: int) -> dict[str, Any]:
    """Return prices of an evaluation and the attempts of every row, as JSON data."""
    scene = pinograsp.load_scene(case.scene)
    print(f"{robot.description.name}-{case.name}: solvers on {starts} starts", flush=True)
    postures = postures_of(robot, scene, case.task, starts, session.seed)
    price = prices(TaskModel(robot, scene, case.task), postures[:PRICED])
    rows: dict[Row, list[Attempt]] = {}

    def attempts(kind: str, algorithm: str, by: str, budget: int | None = None) -> list[Attempt]:
        options = _options(algorithm, KINDS[kind], budget)
        note = f"{kind}, {algorithm}, {options.budget} evaluations"
        found = attempt_all(robot, scene, case.task, postures, by_options(options), session.workers, note)
        rows[kind, algorithm, str(options.budget), by] = found
        return found

    for kind in KINDS:
        # What a solve of one evaluation takes is the time of the projection.
        start = attempts(kind, "LN_COBYLA", "start alone", 1)
        slsqp, cobyla = attempts(kind, "LD_SLSQP", OWN), attempts(kind, "LN_COBYLA", OWN)
        more = np.mean([a.evaluations for a in cobyla]) - np.mean([a.evaluations for a in start])
        each = (_mean_seconds(cobyla) - _mean_seconds(start)) / max(float(more), 1.0)
        given = _mean_seconds(slsqp) - _mean_seconds(start)
        for by, cost in ((EQUAL, each), (CHEAPER, each * price["values"] / price["evaluate"])):
            attempts(kind, "LN_COBYLA", by, max(1, round(given / cost)))
    return {"price": price, "rows": [{"row": row, "attempts": as_data(found)} for row, found in rows.items()]}


def _mean_seconds(attempts: list[Attempt]) -> float:
    return float(np.mean([attempt.seconds for attempt in attempts]))


def prices(model: TaskModel, postures: np.ndarray) -> dict[str, float]:
    """Return seconds of an evaluation, and of the values alone, near the solutions of some starts."""
    solver = LocalSolver(model, SolverOptions())
    with threadpool_limits(1):
        solutions = [solver.solve(index, posture) for index, posture in enumerate(postures)]
        points = [(solver.problem(s.assignment), s.x) for s in solutions for _ in range(10)]
        began = time.perf_counter()
        for problem, x in points:
            problem.evaluate(x)
        between = time.perf_counter()
        for problem, x in points:
            _values(problem, x)
        end = time.perf_counter()
    return {"evaluate": (between - began) / len(points), "values": (end - between) / len(points)}


def _values(problem: GraspProblem, x: np.ndarray) -> object:
    """Compute what an evaluation computes, without the derivatives of forces and constraints."""
    state = problem.state(x)
    return state.surface, state.distances, state.forces, state.statics.residual
