"""Hands that hold a proposed pair: the trial, how far they may turn, and how an arm is brought there."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from test_proposals import holding

from pinograsp import ContactPair, Cylinder, Robot, Scene, Sphere
from pinograsp.geometry.antipodal import Pairs
from pinograsp.kinematics.wrist import wrist_pose
from pinograsp.problem import GraspProblem, Hold, TaskModel
from pinograsp.problem.contact_pairs import proposal
from pinograsp.problem.pair_holds import HoldFinder
from pinograsp.problem.proposals import Proposals
from pinograsp.solve.held_hand import BETWEEN, between, brought, turned, turned_about
from pinograsp.solve.pair_trials import TURNS, PairTrials


def test_a_pair_is_held_in_a_trial_unless_something_is_in_the_way_of_the_hand(gen3: Robot, glovebox: Scene) -> None:
    """A plate is held at its rim; in the middle of its faces the palm is in the plate, however the hand is turned."""
    plate = TaskModel(gen3, holding(glovebox, Cylinder(radius=0.15, height=0.03)), "sphere")
    trials, finder = PairTrials(plate), HoldFinder(plate)
    held = {}
    for x in (0.0, 0.135):
        points, normals = np.array([[x, 0.0, 0.015], [x, 0.0, -0.015]]), np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
        at_rim = Pairs(np.array([[[0.135, 0.0, 0.015], [0.135, 0.0, -0.015]]]), normals[None])
        holds = finder.holds(at_rim)
        assert holds is not None
        shift = np.eye(4)
        shift[0, 3] = x - 0.135
        there = holds._replace(pads=shift @ holds.pads)
        held[x] = trials.held(ContactPair(points, normals, 0.03), there)
    assert held[0.0] == ()
    [found] = held[0.135]
    np.testing.assert_allclose(np.abs(found.contacts.points[:, 2]), 0.015, atol=1e-5)
    outward = np.sign(found.contacts.points[:, 2:]) * [0.0, 0.0, 1.0]
    np.testing.assert_allclose(found.contacts.normals, -outward, atol=1e-5)


def test_a_hand_that_holds_a_pair_may_turn_as_far_as_the_object_is_out_of_its_way(gen3: Robot, glovebox: Scene) -> None:
    """A ball is held from all sides; the rim of a plate from outside, the wrist beyond the rim."""
    ball, plate = Sphere(radius=0.03), Cylinder(radius=0.15, height=0.03)
    for shape, points, all_round in (
        (ball, np.array([[0.0, 0.0, 0.03], [0.0, 0.0, -0.03]]), True),
        (plate, np.array([[0.135, 0.0, 0.015], [0.135, 0.0, -0.015]]), False),
    ):
        model, normals = TaskModel(gen3, holding(glovebox, shape), "sphere"), np.array([[0.0, 0.0, 1.0], [0, 0, -1.0]])
        holds = HoldFinder(model).holds(Pairs(points[None], normals[None]))
        assert holds is not None
        for held in PairTrials(model).held(ContactPair(points, normals, np.ptp(points[:, 2])), holds):
            hold = held.hold
            wrists = [turned_about(*hold.axis, turn) @ hold.T_wrist for turn in hold.turns]
            assert (len(hold.turns) == len(TURNS)) == all_round
            if not all_round:
                assert min(np.hypot(*T[:2, 3]) for T in wrists) > 0.15
            for T in wrists:  # at a right angle to the normals wherever it turns
                np.testing.assert_allclose(T[:3, 2] @ normals[0], hold.T_wrist[:3, 2] @ normals[0], atol=1e-6)


def test_a_hold_is_turned_to_where_the_wrist_turns_least() -> None:
    """Compared with all turns; and no farther than the turns that were looked at reach."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        T, there = np.eye(4), np.eye(4)
        T[:3, :3], there[:3, :3] = pin.exp3(rng.normal(size=3)), pin.exp3(2.0 * rng.normal(size=3))
        along = rng.normal(size=3)
        axis = np.stack([rng.normal(size=3), along / np.linalg.norm(along)])
        hold = Hold(T, np.zeros(1), np.zeros(4), (0, 1), axis, TURNS)
        least = min(
            between(there, hold._replace(T_wrist=turned_about(*axis, t) @ T)) for t in np.arange(0, 6.29, 0.002)
        )
        assert between(there, turned(hold, there)) == pytest.approx(least, abs=1e-5)
        np.testing.assert_allclose(turned(hold, there).axis, axis)
        alone = turned(hold._replace(turns=np.zeros(1)), there)
        assert float(np.linalg.norm(pin.log3(alone.T_wrist[:3, :3] @ T[:3, :3].T))) <= BETWEEN + 1e-9


def test_an_arm_is_brought_to_a_hold_or_said_not_to_come_there(gen3: Robot, glovebox: Scene) -> None:
    model = TaskModel(gen3, holding(glovebox, Sphere(radius=0.03)), "sphere")
    given, came = proposal(Proposals(model, 0, PairTrials(model).held).here(model, 1)[0], model), 0
    problem = GraspProblem(model, given.holds[0].assignment, desired=given.desired)
    start = 0.5 * (problem.lower + problem.upper)
    for turn in given.holds[0].turns:
        hold = given.holds[0]
        hold = hold._replace(T_wrist=turned_about(*hold.axis, turn) @ hold.T_wrist)
        x = brought(problem, start, hold)
        if x is not None:
            came += 1
            state = problem.state(x)
            np.testing.assert_allclose(wrist_pose(state.configuration), hold.T_wrist, atol=1e-3)
            np.testing.assert_allclose(state.surface[0], 0.0, atol=1e-3)
            assert (x >= problem.lower).all()
            assert (x <= problem.upper).all()
    assert came >= 3
    beyond = given.holds[0].T_wrist.copy()
    beyond[0, 3] += 5.0
    assert brought(problem, start, given.holds[0]._replace(T_wrist=beyond)) is None
