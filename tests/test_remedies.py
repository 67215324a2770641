"""Remedies: the least changes that make a task work, the search for them, and what is said where there is none."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from conftest import TOY_URDF, RobotFactory, SceneFactory
from test_painted import write_obj

import pinograsp
from pinograsp import (
    Band,
    Body,
    Box,
    Cone,
    Ellipsoid,
    Explanation,
    HalfSpace,
    Mesh,
    Object,
    Outside,
    Painted,
    Planner,
    Pose,
    Remedy,
    Scene,
    Sector,
    SolverOptions,
    Sphere,
    Tried,
)
from pinograsp.database import cache
from pinograsp.geometry.regions import membership
from pinograsp.kinematics.robot import Robot
from pinograsp.planning.relaxations import suitable
from pinograsp.planning.relaxations.regions import grown
from pinograsp.planning.relaxations.variant import Failure
from pinograsp.planning.remedies import remedies
from pinograsp.planning.trials import Trials
from pinograsp.progress import no_report
from pinograsp.results.table import explanation_lines


@pytest.fixture(scope="module")
def room(make_toy_scene: SceneFactory) -> Scene:
    return make_toy_scene()


def explained(robot: Robot, scene: Scene) -> Explanation:
    return pinograsp.explain(robot, scene, "ball", starts=6, workers=1, deadline=300.0)


def first_remedy(robot: Robot, scene: Scene, kind: str, *bodies: str) -> Remedy:
    """Return the first remedy that is found for a task that fails for some reason, for which bodies are in the way."""
    failure = Failure(scene, "ball", np.zeros(3), bodies, (kind,))
    with Planner(robot, scene, workers=1) as planner:
        database = planner._databases.of(scene, scene.task("ball").margin)
        trials = Trials(robot, database, "ball", SolverOptions(), 0, math.inf)
        found = remedies(failure, trials, no_report)
        return next(outcome for outcome in found if isinstance(outcome, Remedy))


@pytest.fixture(scope="module")
def lighter(toy: Robot, room: Scene) -> tuple[Scene, Explanation]:
    scene = room.with_task("ball", wrench={"force": (0.0, 0.0, -30.0)})
    return scene, explained(toy, scene)


def test_the_remedy_of_a_load_is_what_can_be_carried(toy: Robot, lighter: tuple[Scene, Explanation]) -> None:
    scene, explanation = lighter
    (remedy,) = explanation.remedies
    assert (remedy.kind, remedy.unit) == ("weight", "N")
    assert 5.0 < remedy.amount < 6.69  # to 10 % of what is taken away, and strictly within the friction cones
    assert explanation.refusal.startswith("two pads that are parallel carry less than 6.69 N")
    changed = remedy.apply(scene)
    assert changed.wrench_of(changed.task("ball")).force == pytest.approx((0.0, 0.0, -remedy.amount))
    assert pinograsp.plan(toy, changed, "ball", starts=6, seed=5, workers=1).verified
    assert remedy.text in "\n".join(explanation_lines(explanation))


def test_the_remedy_of_a_margin_that_leaves_no_room_is_a_smaller_one(toy: Robot, room: Scene) -> None:
    """With such a margin the arm is nowhere free: the starts of the trials are those of the usual one."""
    margins = room.task("ball").margin
    scene = room.with_task("ball", margin=margins.model_copy(update={"enclosure": 0.5}))
    explanation = explained(toy, scene)
    assert "no pad can get there" in explanation.refusal
    remedy = next(remedy for remedy in explanation.remedies if remedy.kind == "margin")
    assert 0.0 < remedy.amount <= 0.5
    changed = remedy.apply(scene)
    assert changed.task("ball").margin.enclosure == pytest.approx(0.5 - remedy.amount)
    assert pinograsp.plan(toy, changed, "ball", starts=6, seed=5, workers=1).verified


def test_the_remedy_of_an_object_in_an_obstacle_is_to_move_it_out(
    toy: Robot, room: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "SIZE", 4000)  # of databases of its own, one for each place of the obstacle
    front = Body(shape=Box(size=(0.3, 0.02, 0.2)), pose=Pose(position=(0.0, -0.0235, 0.222)))
    scene = room.with_obstacle("front", front)
    remedy = first_remedy(toy, scene, "objects.pose", "front")
    assert remedy.kind == "move obstacle"
    assert "'front'" in remedy.text and "along -y" in remedy.text
    assert 0.0105 <= remedy.amount <= 0.02  # 11.5 mm deep, 1 mm may stay; the fingers want their margin
    moved = remedy.apply(scene).obstacles["front"].pose.position
    assert moved[1] == pytest.approx(-0.0235 - remedy.amount)


def test_the_remedy_of_an_object_that_no_jaw_is_wide_enough_for_is_the_width_that_is_lacking(
    make_toy: RobotFactory, room: Scene
) -> None:
    """A jaw that opens 60 mm on either side, and a box of 140 mm: 20 mm are lacking, found to 10 %."""
    urdf = TOY_URDF.replace('multiplier="1.25" offset="0.002"', 'multiplier="1" offset="0"')
    robot = make_toy(urdf)
    box = Object(shape=Box(size=(0.14, 0.02, 0.02)), pose=Pose(position=(0.0, 0.0, 0.222)))
    scene = room.with_object("ball", box).with_task("ball", desired_contacts=[[0.07, 0.0, 0.0], [-0.07, 0.0, 0.0]])
    remedy = first_remedy(robot, scene, "objects.shape")
    assert remedy.kind == "jaw"
    assert 0.020 <= remedy.amount <= 0.0221
    assert remedy.text == f"a jaw that opens {1e3 * remedy.amount:.1f} mm wider, or 'ball' narrower by as much"
    narrower = remedy.apply(scene)
    assert cast(Box, narrower.objects["ball"].shape).size == pytest.approx((0.14 - remedy.amount, 0.02, 0.02))
    assert pinograsp.plan(robot, narrower, "ball", starts=6, seed=5, workers=1).verified


def test_the_remedy_of_a_sector_that_ends_too_soon_is_a_wider_one(toy: Robot, room: Scene) -> None:
    """The hand can hold the ball at +x and -x alone; the sector ends 0.1 rad, or 2.5 mm, beside +x."""
    half = 0.5 * math.pi + 0.1
    scene = room.with_task("ball", allowed_contacts=Sector(middle=half + 0.1, half_width=half))
    remedy = first_remedy(toy, scene, "contact region")
    assert remedy.kind == "region"
    assert 0.0025 <= remedy.amount <= 0.0028
    wider = cast(Sector, remedy.apply(scene).task("ball").allowed_contacts)
    assert wider.half_width == pytest.approx(half + remedy.amount / 0.025, abs=1e-3)
    assert wider.middle == pytest.approx(half + 0.1)


# ---- changes


def changed(failure: Failure, kind: str, size: float, way: int = 0) -> Scene:
    """Return the scene of a failure with a change."""
    change = next(change for change in suitable(failure) if change.kind == kind)
    return Remedy(kind, "", size, change.unit, change.variants[way].changes(size), 0, 0).apply(failure.scene)


def test_regions_grow() -> None:
    assert grown(Band(z=(0.02, 0.024)), 0.003, 1.0) == Band(z=(0.017, 0.027))
    half = HalfSpace(normal=(0.0, 0.0, 1.0), offset=0.01)
    assert grown(half, 0.004, 1.0) == HalfSpace(normal=(0.0, 0.0, 1.0), offset=0.006)
    assert grown(Outside(part=half), 0.004, 1.0) == Outside(part=HalfSpace(normal=(0.0, 0.0, 1.0), offset=0.014))
    assert grown(Painted(material="grip"), 0.004, 1.0) == Painted(material="grip", beyond=0.004)
    assert grown(Outside(part=Painted(group="a")), 0.004, 1.0) == Outside(part=Painted(group="a", beyond=-0.004))


def test_sectors_grow_by_arcs_until_they_are_all_around() -> None:
    sector = Sector(middle=1.0, half_width=0.4)
    assert grown(sector, 0.005, 0.05) == Sector(middle=1.0, half_width=0.5)
    narrower = grown(Outside(part=sector), 0.005, 0.05)
    assert cast(Sector, cast(Outside, narrower).part).half_width == pytest.approx(0.3)
    with pytest.raises(pinograsp.InputError, match="nothing is left"):
        grown(sector, -0.03, 0.05)
    whole = grown(Sector(middle=1.0, half_width=3.0), 0.01, 0.05)
    angles = np.linspace(0.0, math.tau, 100)
    circle = 0.05 * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(100)])
    assert (membership(whole)(circle)[0] > 0.0).all()


def test_a_wider_region_is_measured_where_the_surface_is_farthest_from_the_axis(room: Scene) -> None:
    scene = room.with_task("ball", allowed_contacts=Sector(middle=0.0, half_width=1.0))
    wider = changed(Failure(scene, "ball", np.zeros(3), (), ("contact region",)), "region", 0.005)
    assert cast(Sector, wider.task("ball").allowed_contacts).half_width == pytest.approx(1.2, abs=1e-3)


def test_what_is_painted_grows_in_the_scene(room: Scene, tmp_path: Path) -> None:
    write_obj(tmp_path / "can.obj")
    can = Object(shape=Mesh(file=tmp_path / "can.obj"), pose=Pose(position=(0.0, 0.0, 0.222)))
    scene = room.with_object("can", can).with_task(
        "ball", object="can", desired_contacts=None, forbidden_contacts=Painted(material="rest")
    )
    grip = changed(Failure(scene, "ball", np.zeros(3), (), ("contact region",)), "region", 0.002)
    assert grip.task("ball").forbidden_contacts == Painted(material="rest", beyond=-0.002)
    region = grip.region_of(grip.task("ball"))
    assert region is not None
    heights = np.array([[0.0423, 0.0, z] for z in (0.031, 0.033, 0.035)])  # paint from 34 mm on, 2 mm less is forbidden
    assert (membership(region)(heights)[0] > 0.0).tolist() == [False, True, True]


@pytest.mark.parametrize(
    ("shape", "narrower"),
    [
        (Box(size=(0.05, 0.03, 0.04)), Box(size=(0.05, 0.026, 0.04))),
        (Sphere(radius=0.03), Sphere(radius=0.028)),
        (
            Cone(bottom_radius=0.03, top_radius=0.02, height=0.1),
            Cone(bottom_radius=0.028, top_radius=0.018, height=0.1),
        ),
        (Ellipsoid(semi_axes=(0.02, 0.04, 0.05)), Ellipsoid(semi_axes=(0.018, 0.04, 0.05))),
    ],
    ids=lambda shape: shape.type,
)
def test_a_wider_jaw_is_a_narrower_object(room: Scene, shape: Any, narrower: Any) -> None:
    body = Object(shape=shape, pose=Pose(position=(0.0, 0.0, 0.222)))
    scene = room.with_object("ball", body).with_task("ball", desired_contacts=None)
    there = changed(Failure(scene, "ball", np.zeros(3), (), ("objects.shape",)), "jaw", 0.004)
    for key, value in narrower.model_dump(exclude={"type"}).items():
        assert getattr(there.objects["ball"].shape, key) == pytest.approx(value)


@pytest.mark.parametrize(
    ("half", "sizes"),
    [(0.05, (0.016, 0.032)), (0.0565, (0.032,)), (0.06, ()), (0.04, (0.001, 0.002, 0.004, 0.008, 0.016, 0.032))],
)
@pytest.mark.parametrize("desired", [True, False])
def test_no_jaw_is_tried_that_cannot_be_wide_enough(
    half: float, sizes: tuple[float, ...], desired: bool, room: Scene
) -> None:
    """One that opens to 85 mm, at an object of 100 mm: 15 mm are missing. Of one of 120 mm more than is tried is."""
    points = ((half, 0.0, 0.0), (-half, 0.0, 0.0)) if desired else None
    ball = Object(shape=Box(size=(2.0 * half, 0.2, 0.2)))
    scene = room.with_object("ball", ball).with_task("ball", desired_contacts=points)
    found = suitable(Failure(scene, "ball", np.zeros(3), (), ("objects.shape",), jaw=(0.0, 0.085)))
    assert [change.sizes for change in found if change.kind == "jaw"] == ([sizes] if sizes else [])


def test_a_change_that_cannot_be_made_is_not_said_to_be_tried(toy: Robot, room: Scene) -> None:
    """A cone is not made narrower between desired contacts."""
    cone = Object(shape=Cone(bottom_radius=0.03, top_radius=0.02, height=0.05), pose=room.objects["ball"].pose)
    scene = room.with_object("ball", cone).with_task("ball", desired_contacts=((0.025, 0, 0), (-0.025, 0, 0)))
    failure = Failure(scene, "ball", np.zeros(3), (), ("pad tangency",), jaw=(0.0, 0.137))
    assert [change.kind for change in suitable(failure)].count("jaw") == 1
    with Planner(toy, scene, workers=1) as planner:
        database = planner._databases.of(scene, scene.task("ball").margin)
        trials = Trials(toy, database, "ball", SolverOptions(), 0, math.inf)
        outcomes = [outcome.kind for outcome in remedies(failure, trials, no_report)]
    assert "jaw" not in outcomes


@pytest.mark.parametrize(
    ("jaw", "radii"), [((0.07, 0.1), [0.032]), ((0.0, 0.05), [0.028]), ((0.062, 0.1), [0.032]), (None, [0.028])]
)
def test_what_is_thinner_than_the_jaw_closes_is_made_wider(
    room: Scene, jaw: tuple[float, float] | None, radii: list[float]
) -> None:
    body = Object(shape=Sphere(radius=0.03), pose=Pose(position=(0.0, 0.0, 0.222)))
    scene = room.with_object("ball", body).with_task("ball", desired_contacts=None)
    failure = Failure(scene, "ball", np.zeros(3), (), ("objects.shape",), jaw=jaw)
    found = [change for change in suitable(failure) if change.kind == "jaw"]
    there = [
        Remedy("jaw", "", 0.0, "m", c.variants[0].changes(0.004), 0, 0).apply(scene).objects["ball"] for c in found
    ]
    assert [cast(Sphere, body.shape).radius for body in there] == pytest.approx(radii)
    closes = found[0].variants[0].text(0.004) == "a jaw that closes 4.0 mm further, or 'ball' wider by as much"
    assert closes == (radii == [0.032])


def test_what_is_in_the_way_is_what_is_near_where_nothing_is_named(room: Scene) -> None:
    def post(x: float) -> Body:
        return Body(shape=Sphere(radius=0.02), pose=Pose(position=(x, 0.0, 0.222)))

    scene = room.with_obstacle("near", post(0.1)).with_obstacle("far", post(0.38))
    moves = [
        c for c in suitable(Failure(scene, "ball", np.zeros(3), (), ("objects.pose",))) if c.kind == "move obstacle"
    ]
    assert [change.without for change in moves] == [scene.without_obstacle("near")]
    moved = moves[0].variants[0].changes(0.01)
    (pose,) = moved.values()
    assert pose["position"] == pytest.approx([0.11, 0.0, 0.222])


def test_a_move_is_no_answer_to_what_is_refused_wherever_the_object_stands(room: Scene) -> None:
    for kind, moves in (("tasks.wrench", False), ("objects.shape", False), ("objects.pose", True), ("approach", True)):
        kinds = [change.kind for change in suitable(Failure(room, "ball", np.zeros(3), (), (kind,)))]
        assert ("move object" in kinds) == moves


# ---- the search


class Told:
    """In place of trials: what helps is told by a rule, and what is asked is kept."""

    def __init__(self, rule: Callable[[Scene], bool], sure: Callable[[Scene], bool], plans: int = 1000) -> None:
        self.rule, self.rule_of_sure, self.plans = rule, sure, plans
        self.asked: list[Scene] = []
        self.shares: list[float] = []

    def share(self, parts: float) -> None:
        assert parts >= 1.0
        self.shares.append(parts)

    def helps(self, scene: Scene) -> bool:
        if len(self.asked) == self.plans:
            raise TimeoutError
        self.asked.append(scene)
        return self.rule(scene)

    def sure(self, scene: Scene) -> tuple[int, int]:
        return (3, 5) if self.rule_of_sure(scene) else (2, 32)


def searched(failure: Failure, told: Told) -> dict[str, Remedy | Tried]:
    return {found.kind: found for found in remedies(failure, cast(Trials, told), no_report)}


def at_margin(most: float) -> Callable[[Scene], bool]:
    return lambda scene: scene.task("ball").margin.enclosure <= most


def failure_of(scene: Scene, kind: str) -> Failure:
    return Failure(scene, "ball", np.array([0.0, 0.0, 0.4]), (), (kind,))


@pytest.mark.parametrize(("most", "sure"), [(0.0031, 0.0031), (0.0012, 0.0012), (0.0031, 0.0026)])
def test_a_margin_is_made_as_little_smaller_as_helps(room: Scene, most: float, sure: float) -> None:
    """Of 5 mm, to 10 % of what is taken away, and up to 25 % more where the longer plan wants it."""
    told = Told(at_margin(most), at_margin(sure))
    found = searched(failure_of(room, "enclosure clearance"), told)["margin"]
    assert isinstance(found, Remedy)
    lacking = 0.005 - most if sure == most else 0.005 - sure
    assert lacking <= found.amount <= 1.26 * 1.1 * lacking
    assert (found.verified, found.tried) == (3, 5)
    assert at_margin(sure)(found.apply(room))


@pytest.mark.parametrize("done", [1, 24, 1304])
def test_a_scene_that_works_with_other_starts_is_not_changed(room: Scene, done: int) -> None:
    told = Told(lambda scene: True, lambda scene: True)
    (remedy,) = remedies(replace(failure_of(room, "contact gap"), done=done), cast(Trials, told), no_report)
    assert isinstance(remedy, Remedy)
    assert (remedy.kind, remedy.changes, remedy.verified, remedy.tried) == ("starts", {}, 3, 5)
    assert remedy.amount == max(5, done)
    assert remedy.text == f"plan with {max(5, done)} starts or more"
    assert remedy.apply(room) == room


def test_the_more_starts_have_failed_the_less_is_another_plan_worth(room: Scene) -> None:
    """A short plan finds none: after many starts that is the end of it, and after none of them there is no scene."""
    asked = list[Scene]()

    def sure(scene: Scene) -> bool:
        asked.append(scene)
        return scene == room

    for done, kinds in ((6, ["starts"]), (32, ["move object"]), (0, ["move object"])):
        told = Told(lambda scene: scene != room and bool(scene.tasks), sure)
        asked.clear()
        failure = replace(failure_of(room, "approach"), done=done)
        assert [found.kind for found in remedies(failure, cast(Trials, told), no_report)] == kinds
        assert (room in asked) == (done == 6)


def test_a_margin_that_does_not_help_at_all_costs_one_plan(room: Scene) -> None:
    told = Told(lambda scene: False, lambda scene: False)
    found = searched(failure_of(room, "self clearance"), told)["margin"]
    least = room.task("ball").margin.robot
    assert found == Tried("margin", "a margin.robot of down to 0.0 mm", least, "m", whole=True, unsure=False)
    assert sum(scene.task("ball").margin.robot == 0.0 for scene in told.asked) == 1


def test_of_directions_the_least_is_found(room: Scene) -> None:
    """The object may go 30 mm up or 12 mm to the side."""

    def free(scene: Scene) -> bool:
        x, _, z = scene.objects["ball"].pose.position
        return z >= 0.222 + 0.030 or x <= -0.012

    found = searched(failure_of(room, "contact gap"), Told(free, free))["move object"]
    assert isinstance(found, Remedy)
    assert found.text == f"move 'ball' by {1e3 * found.amount:.0f} mm along -x"
    assert 0.012 <= found.amount <= 0.0141


def test_a_plan_says_how_far_an_object_was_moved_in_vain(room: Scene) -> None:
    told = Told(lambda scene: False, lambda scene: False)
    found = searched(failure_of(room, "contact gap"), told)["move object"]
    assert isinstance(found, Tried)
    assert (found.furthest, found.whole) == (0.32, True)
    explanation = Explanation(tried=(found,), done=6)
    lines = explanation_lines(explanation)
    assert lines[-2:] == [
        "no single change that was tried helps",
        "tried: 'ball' moved along 7 directions by up to 320 mm, no grasp",
    ]


def test_a_search_whose_time_is_over_says_how_far_it_came(room: Scene) -> None:
    told = Told(lambda scene: False, lambda scene: False, plans=10)  # seven directions by 80 mm, three by 160 mm
    found = searched(failure_of(room, "contact gap"), told)["move object"]
    assert isinstance(found, Tried)
    assert (found.furthest, found.whole) == (0.08, False)
    assert found.ending == "no grasp when the time was over"


def test_what_is_found_as_the_time_ends_is_kept(room: Scene) -> None:
    """The margin helps at 0, and there is no time for more plans: that is the least known."""
    found = searched(failure_of(room, "enclosure clearance"), Told(at_margin(0.003), at_margin(0.003), plans=1))
    remedy = found["margin"]
    assert isinstance(remedy, Remedy)
    assert remedy.amount == 0.005


def test_what_helps_a_little_is_said_to_be_unsure(room: Scene) -> None:
    found = searched(failure_of(room, "enclosure clearance"), Told(at_margin(0.003), lambda scene: False))["margin"]
    assert isinstance(found, Tried)
    assert (found.unsure, found.ending) == (True, "too few starts verified")


def test_a_change_that_cannot_be_larger_gives_the_time_of_the_others_back(room: Scene) -> None:
    """A forbidden sector of 1.4 mm to each side: 0.9 mm less helps in a short plan, 1.6 times that cannot be."""
    radius = cast(Sphere, room.objects["ball"].shape).radius
    scene = room.with_task("ball", forbidden_contacts=Sector(middle=0.0, half_width=0.0014 / radius))

    def small(there: Scene) -> bool:
        return cast(Sector, there.task("ball").forbidden_contacts).half_width * radius <= 0.0005

    told = Told(small, lambda there: False)
    assert isinstance(searched(failure_of(scene, "contact region"), told)["region"], Tried)
    assert told.shares[:3] == [4.0, 1.0, 4.0]  # moves of the object come after it, with three parts


def test_what_is_in_the_way_is_moved_only_where_it_helps_to_take_it_away(room: Scene) -> None:
    post = Body(shape=Sphere(radius=0.02), pose=Pose(position=(0.06, 0.0, 0.222)))
    scene = room.with_obstacle("post", post)
    failure = Failure(scene, "ball", np.zeros(3), ("post",), ("obstacle clearance",))
    told = Told(lambda there: False, lambda there: False)
    found = searched(failure, told)["move obstacle"]
    assert isinstance(found, Tried)
    assert [there for there in told.asked if there.obstacles != scene.obstacles] == [room]

    def apart(there: Scene) -> bool:
        return not there.obstacles or there.obstacles["post"].pose.position[0] >= 0.09

    remedy = searched(failure, Told(apart, apart))["move obstacle"]
    assert isinstance(remedy, Remedy)
    assert 0.03 <= remedy.amount <= 0.034
    assert remedy.text == f"move 'post' by {1e3 * remedy.amount:.0f} mm along +x"


def test_what_is_in_the_way_may_have_a_task_of_its_own(room: Scene) -> None:
    post = Object(shape=Sphere(radius=0.02), pose=Pose(position=(0.06, 0.0, 0.222)), mass=0.1)
    scene = room.with_object("post", post).with_task("post", room.task("ball").model_copy(update={"object": "post"}))
    failure = Failure(scene, "ball", np.zeros(3), ("post",), ("obstacle clearance",))
    told = Told(lambda there: False, lambda there: False)
    assert isinstance(searched(failure, told)["move obstacle"], Tried)
    assert room in told.asked


def test_a_load_has_its_relaxed_problem_first(room: Scene) -> None:
    scene = room.with_task("ball", wrench={"force": (0.0, 0.0, -6.0)})

    def light(there: Scene) -> bool:
        return there.wrench_of(there.task("ball")).force[2] >= -4.0

    told = Told(light, light)
    remedy = searched(failure_of(scene, "friction"), told)["weight"]
    assert isinstance(remedy, Remedy)
    assert 3.7 <= remedy.amount <= 4.0
    first = told.asked[0]
    assert first.wrench_of(first.task("ball")).force[2] == pytest.approx(-6.0 / 33.0, rel=0.01)
