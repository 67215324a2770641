"""Fixtures that several test files share."""

from __future__ import annotations

import pytest

import pinograsp
from pinograsp.descriptions import SceneDescription
from pinograsp.models import RobotModel
from pinograsp.problem import TaskModel


@pytest.fixture(scope="session")
def gen3() -> RobotModel:
    """The shipped arm and gripper, root link at the world's origin."""
    return pinograsp.load_robot("gen3_2f85")


@pytest.fixture(scope="session")
def glovebox() -> SceneDescription:
    return pinograsp.load_scene("glovebox")


@pytest.fixture(scope="session")
def sphere_task(gen3: RobotModel, glovebox: SceneDescription) -> TaskModel:
    return TaskModel(gen3, glovebox, "sphere")
