"""Hands whose synergy matrix the robot file gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import TOY_SCENE, TOY_URDF, RobotFactory, SceneFactory, agree

from pinograsp import build_database, plan
from pinograsp.problem import GraspProblem, TaskModel

OPEN_AND_SHIFT = {
    "synergies": [
        {"name": "open", "joints": {"slide_left": 1.0, "slide_right": 1.0}, "limits": [0.0, 0.1]},
        {"name": "shift", "joints": {"slide_left": 1.0, "slide_right": -0.5}, "limits": [-0.1, 0.1]},
    ],
    "rest": {"slide_left": 0.004},
}
TWO_SLIDERS = TOY_URDF.replace('<mimic joint="slide_left" multiplier="1.25" offset="0.002"/>', "")


def test_synergies_that_share_joints(make_toy: RobotFactory, make_toy_scene: SceneFactory, tmp_path: Path) -> None:
    """A matrix of two columns: the limits of both joints hold though those of the synergies would let them go.

    The left finger reaches around the ball within its limits only if the arm leans over.
    """
    toy = make_toy(TWO_SLIDERS, hand=OPEN_AND_SHIFT)
    np.testing.assert_array_equal(toy.synergies, [[1.0, 1.0], [1.0, -0.5]])
    assert toy.joints_by_name(np.array([0.3, 0.02, 0.01])) == pytest.approx(
        {"shoulder": 0.3, "slide_left": 0.034, "slide_right": 0.015}
    )
    ball = TOY_SCENE["objects"]["ball"] | {"pose": {"position": [0.06, 0.0, 0.222]}}
    scene = make_toy_scene(objects={"ball": ball})
    model, rng = TaskModel(toy, scene, "ball"), np.random.default_rng(0)
    problem = GraspProblem(model, (0, 1))
    rows = slice(2, 6)  # behind V* and the balance
    for x in 0.5 * (problem.lower + problem.upper) + rng.uniform(-0.01, 0.01, (3, len(problem.lower))):
        jacobian = problem.evaluate(x).inequalities.jacobian[rows]
        assert jacobian.any(axis=1).all()
        agree(jacobian, lambda x: problem.evaluate(x).inequalities.values[rows], x)
    with build_database(toy, scene, tmp_path / "toy.duckdb", size=1000, workers=1) as database:
        result = plan(toy, scene, "ball", starts=12, workers=1, database=database)
    assert result.verified >= 10
    assert result.refuted == 0
    for grasp in result.grasps:
        assert -1e-9 <= grasp.joints["slide_left"] <= 0.06 + 1e-9
        assert -1e-9 <= grasp.joints["slide_right"] <= 0.08 + 1e-9
        assert grasp.joints["shoulder"] > 0.1
        sigma = np.linalg.solve(toy.synergies, [grasp.joints["slide_left"] - 0.004, grasp.joints["slide_right"]])
        np.testing.assert_allclose(grasp.synergy, sigma, atol=1e-12)
