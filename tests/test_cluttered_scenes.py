"""The shipped scenes with more than the object in them: most starts end in a grasp, and the check refutes none."""

from __future__ import annotations

import pytest

import pinograsp
from pinograsp import Robot, plan
from pinograsp.database import build, cache, sampling

CLUTTERED = {
    "glovebox_mug": "handle",
    "glovebox_bottles": "neck",
    "glovebox_tray": "screwdriver",
    "glovebox_shelf": "valve",
}
"""Task by scene."""
STARTS = 10


@pytest.fixture(autouse=True)
def small_databases(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (build, sampling):
        monkeypatch.setattr(module, "DRAWS", 8192)
    monkeypatch.setattr(cache, "SIZE", 2000)


@pytest.mark.parametrize("name", CLUTTERED)
def test_most_starts_end_in_a_grasp(gen3: Robot, name: str) -> None:
    result = plan(gen3, pinograsp.load_scene(name), CLUTTERED[name], starts=STARTS, workers=1)
    assert result.done == STARTS and result.refuted == 0
    assert result.verified >= 0.6 * STARTS
