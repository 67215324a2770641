"""Robots of which a file has no SRDF: which pairs of links the optimiser and the verification check all the same."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from conftest import TOY_ROBOT, TOY_URDF, RobotFactory, collision_model

from pinograsp import Robot
from pinograsp.collision.allowed_pairs import allowed_pairs
from pinograsp.descriptions import RobotDescription, Scene
from pinograsp.verification.check import Verifier

MARGIN = 0.005
Pairs = set[frozenset[str]]


def pair(*links: str) -> frozenset[str]:
    return frozenset(links)


def names_of_allowed(robot: Robot, margin: float) -> set[frozenset[str]]:
    return {frozenset(key.name for key in pair) for pair in allowed_pairs(robot, margin)}


def solver_pairs(robot: Robot, scene: Scene, task: str) -> Pairs:
    collision = collision_model(robot, scene, task)
    return {pair(p.link, p.other) for p in collision.pairs if p.kind == "self clearance"}


def verified_pairs(robot: Robot, scene: Scene, task: str) -> tuple[Pairs, Pairs]:
    """Pairs that must keep the margin, and those that must not touch."""
    verifier = Verifier(robot.description, scene, task)
    lists = (verifier._clearances.enabled, verifier._clearances.never)
    return tuple({pair(a.link, b.link) for a, b in pairs} for pairs in lists)  # type: ignore[return-value]


@pytest.fixture(scope="module")
def bare_gen3(gen3: Robot) -> Robot:
    return Robot(RobotDescription.model_validate(gen3.description.model_dump() | {"srdf": None}))


@pytest.mark.parametrize("name", ["gen3", "bare_gen3"])
def test_solver_and_verification_check_the_same_pairs(
    name: str, glovebox: Scene, request: pytest.FixtureRequest
) -> None:
    robot = request.getfixturevalue(name)
    enabled, never = verified_pairs(robot, glovebox, "sphere")
    assert solver_pairs(robot, glovebox, "sphere") == enabled
    assert enabled
    assert never
    assert not enabled & never


def test_the_srdf_of_the_gen3_excuses_all_that_is_found_without_it(gen3: Robot, bare_gen3: Robot) -> None:
    """Adjacent, always and never: MoveIt's assistant found the same, and more with its 10,000 postures."""
    found = names_of_allowed(bare_gen3, MARGIN)
    assert found <= gen3.urdf.disabled_pairs
    sides = [
        [f"robotiq_85_{side}_{part}_link" for part in ("finger_tip", "inner_knuckle")] for side in ("left", "right")
    ]
    assert {pair(*links) for links in sides} <= found  # joined by a pin that the tree does not have
    assert pair("base_link", "shoulder_link") in found
    assert pair("base_link", "half_arm_1_link") not in found


def test_an_srdf_everywhere_decides_alone(gen3: Robot) -> None:
    assert names_of_allowed(gen3, MARGIN) == gen3.urdf.disabled_pairs


CABLE = """
  <link name="carriage"/>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="carriage"/><axis xyz="0 0 1"/>
    <limit lower="-0.002" upper="0.002" effort="1" velocity="1"/>
  </joint>
  <link name="cable">
    <collision><origin xyz="0 0.04 {z}"/><geometry><box size="0.01 0.01 0.02"/></geometry></collision>
  </link>
  <joint name="swivel" type="revolute">
    <parent link="carriage"/><child link="cable"/><axis xyz="0 0 1"/>
    <limit lower="-0.1" upper="0.1" effort="1" velocity="1"/>
  </joint>
</robot>"""
BASE_TOP = -0.03


@pytest.mark.parametrize(
    ("gap", "checked", "claimed"),
    [
        (-0.0100, False, False),  # always deep in
        (0.0010, False, False),  # always near, touches or not
        (0.0025, False, True),  # always near, never touches: then it must not
        (0.0040, True, False),  # now nearer than the margin, now not
        (0.0080, True, False),
    ],
)
def test_what_is_always_near(
    gap: float, checked: bool, claimed: bool, make_toy: RobotFactory, make_toy_scene: Any
) -> None:
    """A box over the base, lifted by up to 2 mm about a gap; two joints away, so no neighbour."""
    urdf = TOY_URDF.replace("</robot>", CABLE.format(z=BASE_TOP + 0.01 + gap))
    robot = make_toy(urdf=urdf, arm=TOY_ROBOT["arm"] | {"joints": ["shoulder", "lift", "swivel"]})
    scene, links = make_toy_scene(), pair("base", "cable")
    enabled, never = verified_pairs(robot, scene, "ball")
    assert (links in enabled) == checked
    assert (links in never) == claimed
    assert (links in solver_pairs(robot, scene, "ball")) == checked


def test_the_margin_of_the_task_counts(make_toy: RobotFactory, make_toy_scene: Any) -> None:
    """8 mm less 2 mm: nearer than a margin of 15 mm everywhere."""
    urdf = TOY_URDF.replace("</robot>", CABLE.format(z=BASE_TOP + 0.01 + 0.008))
    robot = make_toy(urdf=urdf, arm=TOY_ROBOT["arm"] | {"joints": ["shoulder", "lift", "swivel"]})
    assert pair("base", "cable") not in names_of_allowed(robot, MARGIN)
    assert pair("base", "cable") in names_of_allowed(robot, 0.015)


def test_jaws_that_close_need_no_margin_but_may_not_touch(make_toy: RobotFactory, make_toy_scene: Any) -> None:
    """The toy's fingers close to 2 mm; if they close to less than nothing, they are kept apart like an arm."""
    scene, fingers = make_toy_scene(), pair("left", "right")
    enabled, never = verified_pairs(make_toy(), scene, "ball")
    assert fingers in never
    assert fingers not in solver_pairs(make_toy(), scene, "ball")
    further = TOY_URDF.replace('offset="0.002"', 'offset="-0.02"')
    through = make_toy(urdf=further.replace('lower="0.0" upper="0.08"', 'lower="-0.02" upper="0.08"'))
    enabled, never = verified_pairs(through, scene, "ball")
    assert fingers in enabled
    assert fingers in solver_pairs(through, scene, "ball")


def test_the_search_is_quick_and_the_same_every_time(bare_gen3: Robot) -> None:
    robot = Robot(bare_gen3.description)
    began = time.process_time()
    found = names_of_allowed(robot, MARGIN)
    assert time.process_time() - began < 1.0
    assert names_of_allowed(Robot(bare_gen3.description), MARGIN) == found
    turned = bare_gen3.mounted(np.array([[0, 0, 1, 0.3], [0, 1, 0, 0], [-1, 0, 0, 0.2], [0, 0, 0, 1.0]]))
    assert names_of_allowed(turned, MARGIN) == found
