"""The paper's cases, planned for a robot."""

from __future__ import annotations

from dataclasses import dataclass

import pinograsp
from pinograsp.descriptions import Scene

from .cases import Case
from .store import Lines, Store, key_of


@dataclass(frozen=True)
class Session:
    """What the whole page is made with."""

    store: Store
    robots: tuple[pinograsp.Robot, ...]
    cases: tuple[Case, ...]
    starts: int
    seed: int
    workers: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the robots."""
        return tuple(robot.description.name for robot in self.robots)


Results = dict[tuple[str, str], pinograsp.Result]
"""Results by names of robot and case."""


def run_cases(session: Session) -> Results:
    """Plan every case for every robot."""
    return {
        (robot.description.name, case.name): run(
            session, robot, pinograsp.load_scene(case.scene), case, case.name, session.starts
        )
        for robot in session.robots
        for case in session.cases
    }


def run(session: Session, robot: pinograsp.Robot, scene: Scene, case: Case, name: str, starts: int) -> pinograsp.Result:
    """Plan one case, or load its result.

    Args:
        session: seed, workers and store.
        robot: the robot.
        scene: the case's scene, which may differ from the file in its force weight.
        case: the case.
        name: of the result's file, after the robot's name.
        starts: number of starts.
    """
    label = f"{robot.description.name}-{name}"
    options = pinograsp.SolverOptions()
    key = key_of(robot, scene, case.task, starts=starts, seed=session.seed, options=options.to_json())

    def compute() -> pinograsp.Result:
        print(f"{label}: {starts} starts", flush=True)
        return pinograsp.plan(
            robot,
            scene,
            case.task,
            starts=starts,
            workers=session.workers,
            seed=session.seed,
            options=options,
            progress=Lines(),
        )

    return session.store.result(label, key, compute)


def search_seconds(result: pinograsp.Result) -> float:
    """Return the time of a plan without that of its start database, which is made once for a robot and an enclosure."""
    return result.times["total"] - result.times["database"]


def costs(result: pinograsp.Result) -> list[float]:
    """Return U of every verified start, ascending.

    Near-identical grasps count with the U of the best of them.
    """
    return [grasp.cost.U for grasp in result.ranked("U") for _ in range(grasp.count)]


def of_least_U(result: pinograsp.Result) -> pinograsp.Grasp | None:
    """Return the grasp of least U, which is what the paper calls the best."""
    return next(iter(result.ranked("U")), None)


def near_best(of: list[float], best: float) -> int:
    """Return how many of the costs are within 1 % + 1 mm^2 of the best."""
    return sum(1.01 * best + 1.0 >= U for U in of)
