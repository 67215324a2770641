"""The simple way, for comparison: hand poses on a grid, inverse kinematics, collision filter, check.

The pads are put on the desired points, then on pairs of opposite points on a grid of the surface in the order of their
distance from the desired points. For each pair the hand stands at angles about the line through both, either pad on
either point (for two equal fingers: the wrist turned by half a turn), and the arm is solved for from several
starts of the database. What comes of it goes through the same independent check as every grasp. The jaw is closed
exactly to the distance of the points, so Phi is known beforehand and the first pair that succeeds is the best of the
grid.
"""

from __future__ import annotations

import itertools
import math
import time
from collections import Counter
from collections.abc import Callable
from contextlib import closing
from functools import partial
from typing import Any, Literal

import numpy as np

import pinograsp
from pinograsp.execution import own_workers
from pinograsp.planning.attempt import certify
from pinograsp.problem import GraspProblem, TaskModel
from pinograsp.verification.check import Verifier

from . import hand_poses, inverse_kinematics
from .attempts import postures_of
from .cases import Case
from .page import Block, Heading, Table, Text
from .runs import Results, Session, costs, search_seconds
from .store import Lines, key_of

SEEDS = 6
"""Starts of the database from which the arm is solved for each hand pose."""
CLEARANCES = {
    *("enclosure clearance", "obstacle clearance", "self clearance", "self collision"),
    *("object clearance", "pad clearance"),
}
Stage = Literal["no arm posture", "collision", "refuted otherwise", "verified"]
STAGES: tuple[Stage, ...] = ("no arm posture", "collision", "refuted otherwise", "verified")
"""How far a hand pose came."""
CENTERS, TIPS = 0.0, -0.9
"""Where on the pads the contacts are: parts of the way from their centres along the approach."""
Item = tuple[int, float, int, float]
"""Number of the line, angle about it, pad that stands at its first point, where on the pads."""


def alternative_section(session: Session, results: Results) -> list[Block]:
    """Try the simple way in every case for as long as the optimisation took, and return the section."""
    rows = [
        row
        for case in session.cases
        for robot in session.robots
        for row in _rows(session, robot, case, results[robot.description.name, case.name])
    ]
    head = ("case", "robot", "way", "pairs of points", "hand poses", "with an arm posture", "free", "verified")
    return [
        Heading(2, "The simple way: hand poses, inverse kinematics, filter"),
        Text(
            f"Hand poses at {hand_poses.ANGLES} angles about the line through two opposite points, either pad on "
            "either point (the wrist turned by half a turn); numerical inverse kinematics from the "
            f"{SEEDS} nearest starts of the database; the same independent check. First every pose with the centres of "
            "the pads on the desired points; then also with the tips of the pads there; then centres and tips on pairs "
            f"of opposite points of a grid (every {math.degrees(hand_poses.TURN):.0f}° and {1e3 * hand_poses.HEIGHT:g} "
            f"mm on a can, every {math.degrees(hand_poses.SPHERE_TURN):.0f}° on a sphere) in the order of Phi until a "
            "pair succeeds, which is then the best of the grid, or the time is over that the optimisation took on as "
            "many processes. Hand poses count by what the best of their arm postures came to. Two favours: the grid is "
            "one of opposite points, which only round objects have everywhere, and free means free of the meshes, "
            "where the optimisation keeps convex pieces apart."
        ),
        Table((*head, "best U", "time"), rows),
    ]


def _rows(session: Session, robot: pinograsp.Robot, case: Case, result: pinograsp.Result) -> list[tuple[str, ...]]:
    name, seconds = robot.description.name, search_seconds(result)
    grid = {
        name: getattr(module, name)
        for module in (hand_poses, inverse_kinematics)
        for name in dir(module)
        if isinstance(getattr(module, name), (int, float))
    }
    # Another time of the optimisation changes what the simple way may take, so the time is part of the key.
    scene = pinograsp.load_scene(case.scene)
    key = key_of(
        robot, scene, case.task, starts=session.starts, seed=session.seed, grid=grid, seeds=SEEDS, seconds=seconds
    )
    data = session.store.data(f"{name}-{case.name}-simple", key, partial(search, session, robot, case, seconds))
    rows = []
    for way, found in data.items():
        stages = found["stages"]
        posture, free = sum(stages[s] for s in STAGES[1:]), sum(stages[s] for s in STAGES[2:])
        numbers = (found["lines"], sum(stages.values()), posture, free, stages["verified"])
        best = "-" if found["best_U"] is None else f"{found['best_U']:.6g}"
        rows.append((case.title, name, way, *map(str, numbers), best, f"{found['seconds']:.1f} s"))
    best = f"{costs(result)[0]:.6g}" if result.grasps else "-"
    way = f"optimisation, {result.done} starts"
    rows.append((case.title, name, way, *4 * ("",), str(result.verified), best, f"{seconds:.1f} s"))
    return rows


def search(session: Session, robot: pinograsp.Robot, case: Case, seconds: float) -> dict[str, Any]:
    """Return what the desired points alone give, and what the grid gives within a time, as JSON data."""
    print(f"{robot.description.name}-{case.name}: the simple way for up to {seconds:.0f} s", flush=True)
    scene = pinograsp.load_scene(case.scene)
    lines = hand_poses.lines(TaskModel(robot, scene, case.task))
    desired = [line for line in lines if line.phi_mm2 < 1e-9]
    seeds = postures_of(robot, scene, case.task, session.starts, session.seed)[:, : robot.arm_size]
    return {
        "centres on the desired points": _tried(session, robot, case, seeds, desired, (CENTERS,), math.inf),
        "centres or tips there": _tried(session, robot, case, seeds, desired, (CENTERS, TIPS), math.inf),
        "centres or tips on a grid": _tried(session, robot, case, seeds, lines, (CENTERS, TIPS), seconds),
    }


def _tried(
    session: Session,
    robot: pinograsp.Robot,
    case: Case,
    seeds: np.ndarray,
    lines: list[hand_poses.Line],
    places: tuple[float, ...],
    seconds: float,
) -> dict[str, Any]:
    """Try lines in their order until one succeeds or the time is over."""
    began = time.monotonic()
    scene = pinograsp.load_scene(case.scene)
    angles = (2.0 * math.pi * np.arange(hand_poses.ANGLES) / hand_poses.ANGLES).tolist()
    poses = list(itertools.product(angles, (0, 1), places))
    items: list[Item] = [(line, *pose) for line in range(len(lines)) for pose in poses]
    left = Counter(line for line, *_ in items)
    stages, best_U, best_line = Counter[Stage](dict.fromkeys(STAGES, 0)), None, len(lines)
    prepare = partial(_prepare, robot, scene, case.task, lines, seeds, began + seconds)
    lines_printed = Lines()
    with own_workers(session.workers) as pool, closing(pool.run(prepare, items, chunk=4)) as outcomes:
        for line, stage, U in outcomes:
            if stage is None:  # the time is over
                break
            stages[stage] += 1
            left[line] -= 1
            if U is not None:
                best_U, best_line = U if best_U is None else min(best_U, U), min(best_line, line)
            lines_printed(pinograsp.Progress("hand poses", sum(stages.values()), len(items)))
            if best_line < len(lines) and not any(left[i] for i in range(best_line + 1)):
                break
    tried = sum(1 for i in range(len(lines)) if left[i] < len(poses))
    return {"lines": tried, "stages": dict(stages), "best_U": best_U, "seconds": time.monotonic() - began}


def _prepare(
    robot: pinograsp.Robot,
    scene: pinograsp.descriptions.Scene,
    task: str,
    lines: list[hand_poses.Line],
    seeds: np.ndarray,
    deadline: float,
) -> Callable[[Item], tuple[int, Stage | None, float | None]]:
    """Build, in a worker, what tries one hand pose after the other: line, how far it came, U of a verified grasp."""
    model = TaskModel(robot, scene, task)
    problems = [GraspProblem(model, assignment) for assignment in ((0, 1), (1, 0))]
    verifier = Verifier(robot.description, scene, task)
    width = float(np.linalg.norm(lines[0].points[0] - lines[0].points[1])) if lines else 0.0
    solver = inverse_kinematics.ArmSolver(problems[0], width, seeds)

    def attempt(item: Item) -> tuple[int, Stage | None, float | None]:
        number, angle, first_pad, place = item
        if time.monotonic() > deadline:
            return number, None, None
        points = lines[number].points
        rotation, origin = hand_poses.hand_frame(points, angle)
        origin = origin + place * solver.reach * rotation[:, 2]
        furthest: Stage = "no arm posture"
        for posture in solver.solve(rotation, origin, first_pad, SEEDS):
            own = points[[0, 1]] if first_pad == 0 else points[[1, 0]]
            x = np.append(posture, solver.contact_parameters(posture, own))
            certificate, grasp = certify(number, problems[first_pad].state(x), verifier)
            if grasp:
                return number, "verified", grasp.cost.U
            hit = any(figure.name in CLEARANCES for figure in certificate.refuted_by)
            furthest = max(furthest, "collision" if hit else "refuted otherwise", key=STAGES.index)
        return number, furthest, None

    return attempt
