"""The shipped scenes with more than the object in them: most starts end in a grasp, and the check refutes none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import pinograsp
from pinograsp import Database, Robot, Scene, plan, shipped_scenes

CLUTTERED = {"glovebox_mug": "handle", "glovebox_bottles": "neck", "glovebox_tray": "screwdriver", "glovebox_shelf": "valve"}
"""Task by scene."""
STARTS = 10


@pytest.fixture(scope="module", params=CLUTTERED)
def scene(request: pytest.FixtureRequest) -> Scene:
    return pinograsp.load_scene(request.param)


@pytest.fixture
def database(gen3: Robot, scene: Scene, tmp_path: Path) -> Database:
    return pinograsp.build_database(gen3, scene, tmp_path / "few.duckdb", size=2000, workers=1)


def test_most_starts_end_in_a_grasp(gen3: Robot, scene: Scene, database: Database) -> None:
    task = CLUTTERED[scene.name]
    result = plan(gen3, scene, task, starts=STARTS, database=database, workers=1)
    assert result.done == STARTS and result.refuted == 0
    assert result.verified >= 0.6 * STARTS
    region = scene.task(task).allowed_contacts
    assert (region is not None) == (scene.name == "glovebox_mug")
