"""What the weight k of the forces does: case 2 with k over several decades."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import pinograsp
from pinograsp.descriptions import Scene

from .cases import CASES, V_LEAST, Case
from .figures import draw_trade_off
from .page import Block, Heading, Pictures, Table, Text
from .runs import Session, costs, near_best, of_least_U, run

WEIGHTS = (0.01, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4)
CASE = CASES["case2"]


def sweep_section(session: Session, starts: int, folder: Path) -> list[Block]:
    """Plan case 2 with every weight, and return the section with table and figure."""
    rows: list[tuple[str, ...]] = []
    curves: dict[str, list[tuple[float, float, float]]] = {}
    for robot in session.robots:
        name = robot.description.name
        results = {k: _planned(session, robot, k, starts) for k in WEIGHTS}
        # A grasp found with one weight may be the best known for another.
        found = [grasp.cost for result in results.values() for grasp in result.grasps]
        for k, result in results.items():
            best_own = of_least_U(result)
            if best_own is None:
                rows.append((name, f"{k:g}", str(result.verified), *6 * ("-",)))
                continue
            best = min(found, key=lambda cost, k=k: cost.phi_mm2 + k * cost.V)
            curves.setdefault(name, []).append((k, best.phi_mm2, best.V))
            own = best_own.cost
            near = f"{100 * near_best(costs(result), own.U) / result.verified:.1f} %"
            values = [text for cost in (own, best) for text in (f"{cost.phi_mm2:.2f}", f"{cost.V:.4f}")]
            rows.append((name, f"{k:g}", str(result.verified), near, f"{own.U:.6g}", *values))
    spans = [
        f"{name}: {np.ptp([phi for _, phi, _ in curve]):.2g} mm² in Phi, {np.ptp([V for *_, V in curve]):.2g} in V"
        for name, curve in curves.items()
    ]
    file = folder / "weights.png"
    draw_trade_off(curves, file)
    return [
        Heading(2, "Weight of the forces"),
        Text(
            f"Case 2, {starts} starts for every k of U = Phi + k V: the best grasp of these starts, and the best for "
            "this k among the grasps found with any k, which the figure shows. The paper says that a larger k finds "
            f"better forces farther from the desired points, and shows k = 1 only. V cannot go below {V_LEAST:g}."
        ),
        Table(
            (
                *("robot", "k", "verified", "near the best", "best U", "Phi, mm²", "V"),
                *("Phi of any k, mm²", "V of any k"),
            ),
            rows,
        ),
        Text("What k = 0.01 to 10000 changes in the best grasp known: " + "; ".join(spans) + "."),
        Pictures([(file, "Phi against V of the best grasps, case 2")]),
    ]


def _planned(session: Session, robot: pinograsp.Robot, k: float, starts: int) -> pinograsp.Result:
    scene = with_weight(pinograsp.load_scene(CASE.scene), CASE, k)
    return run(session, robot, scene, CASE, f"{CASE.name}-k{k:g}", starts)


def with_weight(scene: Scene, case: Case, k: float) -> Scene:
    """Return the scene with another force weight in the case's task."""
    task = scene.task(case.task).model_copy(update={"force_weight": k})
    return scene.model_copy(update={"tasks": {**scene.tasks, case.task: task}})
