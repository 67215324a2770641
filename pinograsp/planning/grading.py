"""How much the grasps of a plan withstand: computed once for every distinct grasp, when the search is over."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial

from ..descriptions import Scene
from ..execution import Workers
from ..interrupts import taken
from ..kinematics.robot import Robot
from ..problem import TaskModel
from ..progress import Progress, Report, no_report
from ..results import Grasp, ordered
from ..verification import Claim, Figure
from ..verification.check import Verifier
from ..verification.resistance import is_graded, with_resistance

Numbered = tuple[int, Claim]
Graded = tuple[int, tuple[Figure, ...]]


def graded(grasp: Grasp, verifier: Verifier) -> Grasp:
    """Return a grasp with the figures of its resistance; tasks that ask for them have certificates that hold them."""
    return grasp if is_graded(grasp.certificate) else _with(grasp, verifier.resistance(grasp.claim))


def all_graded(
    grasps: Sequence[Grasp], model: TaskModel, workers: Workers, report: Report = no_report
) -> tuple[tuple[Grasp, ...], bool]:
    """Return grasps with the figures of their resistance, in the default order, and whether nothing interrupted it.

    Grasps that an interrupt, or a worker that died, has left without figures are worse in these than all others.

    Args:
        grasps: distinct ones, with valid certificates.
        model: their task.
        workers: share the work.
        report: called after every grasp.
    """
    items = [(number, grasp.claim) for number, grasp in enumerate(grasps) if not is_graded(grasp.certificate)]
    found, whole = dict[int, tuple[Figure, ...]](), True
    try:
        prepare = partial(_grader, model.robot.unmounted, model.scene, model.task_name)
        with closing(workers.run(prepare, items, lost=_lost)) as running:
            for number, figures in running:
                found[number] = figures
                report(Progress("resistance", len(found), len(items)))
    except KeyboardInterrupt:
        taken()
        whole = False
    return ordered([_with(grasp, found.get(number, ())) for number, grasp in enumerate(grasps)]), whole


def _with(grasp: Grasp, figures: tuple[Figure, ...]) -> Grasp:
    return replace(grasp, certificate=with_resistance(grasp.certificate, figures))


def _grader(robot: Robot, scene: Scene, task: str) -> Callable[[Numbered], Graded]:
    """Build, in a worker, what grades claims: the robot is known there, and no model of the task is needed."""
    verifier = Verifier(robot.description, scene, task)
    return lambda item: (item[0], verifier.resistance(item[1]))


def _lost(item: Numbered, reason: str) -> Graded:
    return item[0], ()
