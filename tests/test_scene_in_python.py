"""Scenes and tasks made in Python: without files, validated as these are, and immutable."""

from __future__ import annotations

import copy
import math
import pickle
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import FrozenInstanceError
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from pinograsp import (
    AllOf,
    AnyOf,
    ApproachCone,
    Ball,
    Band,
    Body,
    Box,
    ContactConstants,
    Cuboid,
    Cylinder,
    Enclosure,
    HalfSpace,
    HardFinger,
    InputError,
    Margins,
    Object,
    Outside,
    Pose,
    Robot,
    Scene,
    Sector,
    SoftFinger,
    Sphere,
    Task,
    Wrench,
    load_scene,
    plan,
    read_json,
    shipped_scenes,
    verify,
    write_json,
)
from pinograsp.database.identity import Identity
from pinograsp.errors import TaskError, UnknownNameError
from pinograsp.problem import TaskModel
from pinograsp.problem.checks import check_placement

BALL = Object(shape=Sphere(radius=0.0373), pose=Pose(position=(0.801, 0.0, -0.08)))
HOLD = Task(
    object="ball",
    desired_contacts=((0.0, 0.0373, 0.0), (0.0, -0.0373, 0.0)),
    wrench=Wrench(force=(0.0, 0.0, -0.98)),
    contact=ContactConstants(friction=0.9),
)
ROOM = Scene(
    name="room",
    enclosure=Enclosure(min=(0.0, -0.42, -0.25), max=(1.10, 0.42, 0.363)),
    objects={"ball": BALL},
    tasks={"hold": HOLD},
)


def refused(make: Callable[[], object]) -> InputError:
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.file is None
    assert caught.value.line is None
    assert "\n" not in str(caught.value)
    return caught.value


# ---- made


def test_the_shipped_scene_made_in_python_says_the_same() -> None:
    """Tags and format need not be written; the rest is the file's."""
    shipped = load_scene("glovebox")
    task = shipped.tasks["sphere"]
    made = Scene(
        name="glovebox",
        description=shipped.description,
        enclosure=Enclosure(min=shipped.enclosure.min, max=shipped.enclosure.max),
        mounting=Pose(position=shipped.mounting.position, rpy=shipped.mounting.rpy),
        objects={
            "sphere": Object(
                shape=Sphere(radius=0.0373), pose=shipped.objects["sphere"].pose, mass=shipped.objects["sphere"].mass
            )
        },
        tasks={
            "sphere": Task(
                object="sphere",
                desired_contacts=[(0.0, 0.0373, 0.0), (0.0, -0.0373, 0.0)],  # type: ignore[arg-type]
                wrench=Wrench(force=task.wrench.force),
                contact=ContactConstants(friction=0.9, min_normal_force=0.001, max_force=5.0, kappa=0.01),
                force_weight=1.0,
            )
        },
    )
    assert made == shipped
    assert made.source is None
    assert shipped.source == shipped_scenes()["glovebox"]


@pytest.mark.parametrize("name", sorted(shipped_scenes()))
def test_dict_and_back(name: str) -> None:
    scene = load_scene(name)
    content = scene.to_dict()
    assert not {"source", "digest"} & content.keys()
    again = Scene.from_dict(yaml.safe_load(yaml.safe_dump(content)))
    assert again == scene
    assert again.source is None
    assert again.digest == Scene.from_dict(content).digest != scene.digest
    assert Scene.from_dict(yaml.safe_load(shipped_scenes()[name].read_text())) == scene


def test_every_shape_and_region_without_its_tag() -> None:
    shapes = [Sphere(radius=0.1), Box(size=(0.1, 0.2, 0.3)), Cylinder(radius=0.1, height=0.2)]
    half = HalfSpace(normal=(0.0, 0.0, 1.0), offset=0.1)
    regions = [
        half,
        Band(z=(0.0, 0.1)),
        Sector(middle=0.0, half_width=1.0),
        Ball(center=(0.0, 0.0, 0.0), radius=0.1),
        Cuboid(min=(0.0, 0.0, 0.0), max=(1.0, 1.0, 1.0)),
        AllOf(parts=(half,)),
        AnyOf(parts=(half, half)),
        Outside(part=half),
    ]
    assert [shape.type for shape in shapes] == ["sphere", "box", "cylinder"]
    names = ["half_space", "band", "sector", "ball", "box", "all_of", "any_of", "outside"]
    assert [region.type for region in regions] == names
    scene = ROOM
    for number, shape in enumerate(shapes):
        scene = scene.with_obstacle(f"thing {number}", Body(shape=shape))
    for number, region in enumerate(regions):
        scene = scene.with_task(f"task {number}", HOLD).with_task(f"task {number}", allowed_contacts=region)
    scene = scene.with_task("soft", HOLD).with_task(
        "soft", contact_model=SoftFinger(torsion_radius=0.002, torsional_stiffness=1.0)
    )
    scene = scene.with_task("hard", HOLD).with_task("hard", contact_model=HardFinger())
    again = Scene.from_dict(scene.to_dict())
    assert again == scene
    assert [type(body.shape) for body in again.obstacles.values()] == [Sphere, Box, Cylinder]
    assert [type(again.tasks[f"task {number}"].allowed_contacts) for number in range(8)] == [*map(type, regions)]
    assert again.tasks["soft"].contact_model == SoftFinger(torsion_radius=0.002, torsional_stiffness=1.0)


@pytest.mark.parametrize("kind", [tuple, list, np.array, lambda v: np.array(v, dtype=np.float32)])
def test_vectors_of_every_kind(kind: Callable[[Any], Any]) -> None:
    assert Pose(position=kind([0.5, 0.0, -0.25])) == Pose(position=(0.5, 0.0, -0.25))
    assert Box(size=kind([0.5, 0.25, 1.0])).size == (0.5, 0.25, 1.0)
    assert Band(z=kind([0.0, 0.5])).z == (0.0, 0.5)
    assert HalfSpace(normal=kind([0.0, 1.0, 0.0]), offset=0.0).normal == (0.0, 1.0, 0.0)
    points = kind([[0.0, 0.5, 0.0], [0.0, -0.5, 0.0]])
    task = ROOM.with_task("hold", desired_contacts=points, joint_ranges={"j": kind([0.0, 0.5])}).tasks["hold"]
    assert task.desired_contacts == ((0.0, 0.5, 0.0), (0.0, -0.5, 0.0))
    assert task.joint_ranges == {"j": (0.0, 0.5)}
    for number in (task.desired_contacts[0][1], task.joint_ranges["j"][1]):
        assert type(number) is float


@pytest.mark.parametrize("number", [np.float64(0.5), np.float32(0.5), 1, np.int64(1), np.array(0.5)])
def test_numbers_of_every_kind(number: Any) -> None:
    radius = Sphere(radius=number).radius
    assert type(radius) is float
    assert radius == float(number)


# ---- changed


def test_a_task_is_changed_added_and_replaced() -> None:
    changed = ROOM.with_task("hold", force_weight=2.0, lock={"joint_7": 0})
    assert changed.tasks["hold"] == HOLD.model_copy(update={"force_weight": 2.0, "lock": {"joint_7": 0.0}})
    assert ROOM.tasks["hold"] == HOLD  # the scene itself stays
    both = ROOM.with_task("other", HOLD, start_radius=0.2)
    assert list(both.tasks) == ["hold", "other"]
    assert (both.tasks["other"].start_radius, both.tasks["hold"].start_radius) == (0.2, 0.3)
    assert both.with_task("other", HOLD).tasks["other"] == HOLD
    approach = ApproachCone(direction=(0.0, 0.0, -1.0), angle=0.3)
    assert ROOM.with_task("hold", approach=approach).tasks["hold"].approach == approach
    assert ROOM.with_task("hold", margin={"object": 0.002}).tasks["hold"].margin == Margins(object=0.002)


def test_objects_and_obstacles_are_added_and_replaced() -> None:
    box = Body(shape=Box(size=(0.1, 0.1, 0.1)), pose=Pose(position=(0.5, 0.3, -0.2)))
    more = ROOM.with_obstacle("box", box).with_object("can", Object(shape=Cylinder(radius=0.03, height=0.1)))
    assert more.obstacles == {"box": box}
    assert list(more.objects) == ["ball", "can"]
    assert more.with_obstacle("box", Body(shape=Sphere(radius=0.1))).obstacles["box"].shape == Sphere(radius=0.1)


def test_a_pose_is_a_pose_or_a_matrix() -> None:
    there = Pose(position=(0.7, 0.1, -0.1), rpy=(0.1, 0.2, 0.3))
    by_pose, by_matrix = (ROOM.with_object_pose("ball", pose) for pose in (there, there.matrix))
    assert by_pose.objects["ball"] == BALL.model_copy(update={"pose": there})
    np.testing.assert_allclose(by_matrix.objects["ball"].pose.matrix, there.matrix, atol=1e-15)


# ---- source and digest


def test_what_is_made_in_python_has_no_source_and_the_digest_of_its_content() -> None:
    shipped = load_scene("glovebox")
    moved = shipped.with_object_pose("sphere", Pose(position=(0.7, 0.0, -0.08)))
    assert moved.source is None  # no file says this
    assert len(ROOM.digest) == 64
    same = Scene.from_dict(ROOM.to_dict())
    assert same.digest == ROOM.digest == pickle.loads(pickle.dumps(ROOM)).digest
    others = [
        ROOM.with_object_pose("ball", Pose(position=(0.7, 0.0, -0.08))),
        ROOM.with_task("hold", force_weight=2.0),
        ROOM.with_task("again", HOLD),
        ROOM.with_obstacle("box", Body(shape=Box(size=(0.1, 0.1, 0.1)))),
        ROOM.model_copy(update={"name": "other"}),
        ROOM.model_copy(update={"name": "another"}),
    ]
    assert len({scene.digest for scene in (ROOM, *others)}) == len(others) + 1
    assert others[0].with_object_pose("ball", BALL.pose).digest == ROOM.digest


def test_equal_content_has_one_digest() -> None:
    """Whatever the order of names, and whether zero has a sign."""
    other = {"can": Object(shape=Cylinder(radius=0.03, height=0.1), pose=Pose(position=(0.4, -0.0, 0.0)))}
    one, two = (
        ROOM.model_copy(update={"objects": objects})
        for objects in ({"ball": BALL, **other}, {"can": {**other["can"].fields()}, "ball": BALL})
    )
    assert one == two
    assert one.digest == two.digest
    zero = Object(shape=Cylinder(radius=0.03, height=0.1), pose=Pose(position=(0.4, 0.0, 0.0)))
    assert ROOM.with_object("can", zero).digest == ROOM.with_object("can", other["can"]).digest


def test_a_start_database_belongs_to_walls_and_obstacles_alone(gen3: Robot) -> None:
    shipped = load_scene("glovebox")
    made = Scene.from_dict(shipped.to_dict())
    margins = Margins()
    assert Identity.of(gen3, made, margins).digest == Identity.of(gen3, shipped, margins).digest
    blocked = made.with_obstacle("box", Body(shape=Box(size=(0.1, 0.1, 0.1))))
    assert Identity.of(gen3, blocked, margins).digest != Identity.of(gen3, shipped, margins).digest


def test_a_result_of_a_scene_made_in_python_is_written_read_and_verified(gen3: Robot, tmp_path: Path) -> None:
    scene = Scene.from_dict(load_scene("glovebox").to_dict()).with_task("sphere", force_weight=2.0)
    result = plan(gen3, scene, "sphere", starts=3, workers=1)
    assert result.verified >= 2
    assert result.provenance["sha256"]["scene"] == scene.digest
    write_json(result, tmp_path / "result.json")
    again = read_json(tmp_path / "result.json")
    assert not again.altered
    assert again.setup.scene == scene
    assert (again.setup.scene.source, again.setup.scene.digest) == (None, scene.digest)
    assert verify(again) == ()


# ---- immutable


def test_nothing_of_a_scene_can_be_changed() -> None:
    scene = ROOM.with_task("hold", lock={"joint_7": 0.0}).with_obstacle("box", Body(shape=Box(size=(1.0, 1.0, 1.0))))
    for table in (scene.objects, scene.tasks, scene.obstacles, scene.tasks["hold"].lock, scene.enclosure.walls):
        with pytest.raises(TypeError, match="does not support item assignment"):
            table["other"] = 1  # type: ignore[index]
        with pytest.raises(TypeError, match="does not support item deletion"):
            del table[next(iter(table))]  # type: ignore[attr-defined]
        assert not hasattr(table, "update")
    with pytest.raises(FrozenInstanceError, match="Object cannot be changed"):
        scene.objects["ball"].pose = Pose()  # type: ignore[misc]
    with pytest.raises(FrozenInstanceError, match="Object cannot be changed"):
        del scene.objects["ball"].mass
    for array in (
        scene.mounting.matrix,
        scene.tasks["hold"].wrench.vector,
        next(iter(scene.enclosure.walls.values()))[0],
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    given = {"ball": BALL}
    made = ROOM.model_copy(update={"objects": given})
    given["other"] = BALL
    assert list(made.objects) == ["ball"]


def test_copies_are_as_immutable() -> None:
    assert ROOM.mounting.matrix[3, 3] == 1.0  # computed before it is copied
    for again in (pickle.loads(pickle.dumps(ROOM)), copy.deepcopy(ROOM), ROOM.model_copy(), ROOM.model_copy(deep=True)):
        assert again == ROOM
        assert again.digest == ROOM.digest
        with pytest.raises(TypeError, match="does not support item assignment"):
            again.objects["other"] = BALL  # type: ignore[index]
        with pytest.raises(ValueError, match="read-only"):
            again.mounting.matrix[0] = 1.0
    assert type(ROOM.model_dump()["objects"]) is dict


def test_equality_is_that_of_the_content_though_matrices_were_computed() -> None:
    one, other = Pose(position=(0.1, 0.2, 0.3)), Pose(position=(0.1, 0.2, 0.3))
    assert one.matrix.tolist() == other.matrix.tolist()
    assert one == other
    assert hash(one) == hash(other)
    assert one != Pose(position=(0.1, 0.2, 0.4))
    assert one != 3
    assert Sphere(radius=0.1) != Ball(center=(0.0, 0.0, 0.0), radius=0.1)


# ---- refused

NAN = math.nan
SPHERE = Sphere(radius=0.1)
BAND = Band(z=(0.0, 1.0))
MADE: dict[str, Any] = {name: getattr(ROOM, name) for name in ("name", "enclosure", "objects", "tasks")}
BAD: list[tuple[Callable[[], object], str, list[str]]] = [
    (lambda: Sphere(radius=-1.0), "radius", ["greater than 0", "-1"]),
    (lambda: Sphere(radius=NAN), "radius", ["finite number"]),
    (lambda: Sphere(radius="0.1"), "radius", ["a number is wanted (given: '0.1')"]),  # type: ignore[arg-type]
    (lambda: Sphere(radius=b"1"), "radius", ["a number is wanted"]),  # type: ignore[arg-type]
    (lambda: Box(size=(0.1, 0.1, "0.1")), "size[2]", ["a number is wanted"]),  # type: ignore[arg-type]
    (lambda: Object(shape=SPHERE, mass="8"), "mass", ["a number is wanted"]),  # type: ignore[arg-type]
    (lambda: Pose(position=(1e200, 0.0, 0.0)), "position[0]", ["between -1e+09 and 1e+09", "1e+200"]),
    (lambda: Sphere(radius=1.1e9), "radius", ["between -1e+09 and 1e+09"]),
    (lambda: Object(shape=SPHERE, pose=3), "pose", ["a Pose, or a dict of its keys, is wanted (given: 3)"]),  # type: ignore[arg-type]
    (lambda: Object(shape=SPHERE, pose=np.eye(4)), "pose", ["0.], [0.", "with Pose.of"]),  # type: ignore[arg-type]
    (lambda: Scene(**MADE, mounting=np.eye(4)), "mounting", ["a Pose, or", "with Pose.of"]),  # type: ignore[arg-type]
    (lambda: AllOf(regions=[]), "regions", ["unknown key. Known: parts, type"]),  # type: ignore[call-arg]
    (lambda: AnyOf(parts=(BAND,), q=1), "q", ["unknown key"]),  # type: ignore[call-arg]
    (lambda: Outside(part=BAND, prat=1), "prat", ["Did you mean part?"]),  # type: ignore[call-arg]
    (lambda: AnyOf(parts=[{"type": "all_of", "part": []}]), "parts[0].part", ["Did you mean parts?"]),  # type: ignore[list-item]
    (lambda: Sphere(radius=10**400), "radius", ["number"]),
    (lambda: Sphere(radius=True), "radius", ["a number is wanted", "True"]),
    (lambda: Sphere(radius=np.bool_(True)), "radius", ["a number is wanted"]),  # type: ignore[arg-type]
    (lambda: Sphere(radius=None), "radius", ["a number is wanted", "nothing"]),  # type: ignore[arg-type]
    (lambda: Sphere(radius=np.zeros(2)), "radius", ["a number is wanted"]),  # type: ignore[arg-type]
    (lambda: Sphere(), "radius", ["missing"]),  # type: ignore[call-arg]
    (lambda: Sphere(raduis=1), "raduis", ["unknown key", "Did you mean radius"]),  # type: ignore[call-arg]
    (lambda: Sphere(type="box", radius=1), "type", ["'sphere'"]),  # type: ignore[arg-type]
    (lambda: Box(size=(1.0, 1.0)), "size", ["3 values are wanted", "2 given"]),  # type: ignore[arg-type]
    (lambda: Box(size={1.0, 2.0, 3.0}), "size", ["a list is wanted"]),  # type: ignore[arg-type]
    (lambda: Box(size="123"), "size", ["a list is wanted"]),  # type: ignore[arg-type]
    (lambda: Box(size=np.zeros((3, 1))), "size[0]", ["a number"]),  # type: ignore[arg-type]
    (lambda: Pose(position=np.array(["a", "b", "c"])), "position[0]", ["a number", "'a'"]),  # type: ignore[arg-type]
    (lambda: Pose(rpy=(0.0, NAN, 0.0)), "rpy[1]", ["finite"]),
    (lambda: Pose.of(np.eye(3)), "pose", ["(3, 3), not (4, 4)"]),
    (lambda: Pose.of("here"), "pose", ["must be numbers of shape (4, 4)", "'here'"]),  # type: ignore[arg-type]
    (lambda: Pose.of([[1, 2], [3]]), "pose", ["must be numbers of shape (4, 4)"]),  # type: ignore[arg-type]
    (lambda: Pose.of(2.0 * np.eye(4)), "pose", ["no homogeneous transform"]),
    (lambda: Pose.of(np.full((4, 4), NAN)), "pose", ["not finite"]),
    (lambda: HalfSpace(normal=(0.0, 0.0, 2.0), offset=0.0), "normal", ["length 1, not 2"]),
    (lambda: Band(z=(1.0, 0.0)), "z", ["1 is not below", "end 0"]),
    (lambda: AllOf(parts=()), "parts", ["at least 1", "0 given"]),
    (lambda: Outside(part=SPHERE), "part.type", ["'sphere' is not known"]),  # type: ignore[arg-type]
    (lambda: Outside(part={"type": "band", "z": [1, 0]}), "part.z", ["not below"]),  # type: ignore[arg-type]
    (lambda: Outside(part={"z": [0, 1]}), "part.type", ["missing"]),  # type: ignore[arg-type]
    (lambda: Object(shape=3), "shape", ["a part made with its class, or a dict of its keys, is wanted (given: 3)"]),  # type: ignore[arg-type]
    (lambda: Object(shape=SPHERE, mass=0.0), "mass", ["greater than 0"]),
    (lambda: Body(shape={"type": "spere", "radius": 1}), "shape.type", ["mean sphere"]),  # type: ignore[arg-type]
    (lambda: Enclosure(min=(0.0, 0.0, 1.0), max=(1.0, 1.0, 1.0)), "min[2]", ["below", "along z"]),
    (lambda: ContactConstants(friction=0.5, min_normal_force=9.0), "min_normal_force", ["below max_force, 5 N"]),
    (lambda: ApproachCone(direction=(0.0, 0.0, 1.0), angle=4.0), "angle", ["3.14"]),
    (lambda: ROOM.model_copy(update={"tasks": {}, "objects": None}), "objects", ["a dict is wanted", "nothing"]),
    (lambda: ROOM.model_copy(update={"nmae": "x"}), "nmae", ["unknown key", "Did you mean name"]),
    (lambda: ROOM.model_copy(update={"digets": "x"}), "digets", ["unknown key"]),
    (lambda: ROOM.model_copy(update={"name": "a/b"}), "name", ["slash"]),
    (lambda: ROOM.model_copy(update={"name": ""}), "name", ["at least 1 character"]),
    (lambda: ROOM.with_task("a/b", HOLD), "tasks.a/b", ["slash"]),
    (lambda: ROOM.with_task("a\\b", HOLD), "tasks.a\\b", ["slash"]),
    (lambda: ROOM.model_copy(update={"name": 65 * "a"}), "name", ["65 bytes", "64 are allowed"]),
    (lambda: ROOM.model_copy(update={"name": 33 * "\u00e4"}), "name", ["66 bytes", "64 are allowed"]),
    (lambda: ROOM.with_task("a\0b", HOLD), r"tasks.a\x00b", ["character U+0000"]),
    (lambda: ROOM.with_task("a\nb", HOLD), r"tasks.a\nb", ["character U+000A"]),
    (lambda: ROOM.with_task("a\u202eb", HOLD), r"tasks.a\u202eb", ["character U+202E"]),
    (lambda: ROOM.with_task("", HOLD), "tasks.", ["at least 1 character"]),
    (lambda: ROOM.with_task(3, HOLD), "name", ["must be of class str, not 3"]),  # type: ignore[arg-type]
    (lambda: ROOM.with_task("hold", 3), "tasks.hold", ["a Task, or a dict of its keys, is wanted (given: 3)"]),  # type: ignore[arg-type]
    (lambda: ROOM.with_task("hold", 3, lock={}), "task", ["must be of class Task, not 3"]),  # type: ignore[arg-type]
    (lambda: ROOM.with_object([], BALL), "name", ["must be of class str, not []"]),  # type: ignore[arg-type]
    (lambda: ROOM.with_task("hold", lokc={}), "tasks.hold.lokc", ["unknown key", "Did you mean lock"]),
    (lambda: ROOM.with_task("hold", lock={"joint_7": NAN}), "tasks.hold.lock.joint_7", ["finite"]),
    (lambda: ROOM.with_task("hold", lock={"joint_7": None}), "tasks.hold.lock.joint_7", ["a number", "nothing"]),
    (lambda: ROOM.with_task("hold", lock=["joint_7"]), "tasks.hold.lock", ["a dict is wanted"]),
    (lambda: ROOM.with_task("hold", lock={7: 0.0}), "tasks.hold.lock.7", ["a text is wanted"]),
    (lambda: ROOM.with_task("hold", joint_ranges={"a": (1, 0)}), "tasks.hold.joint_ranges.a", ["1 is above", "0"]),
    (lambda: ROOM.with_task("hold", pads=("left", "left")), "tasks.hold.pads[1]", ["twice"]),
    (lambda: ROOM.with_task("hold", desired_contacts=np.zeros((1, 3))), "tasks.hold.desired_contacts", ["at least 2"]),
    (
        lambda: ROOM.with_task("hold", allowed_contacts={"type": "band", "z": [0, 1], "y": 1}),
        "tasks.hold.allowed_contacts.y",
        ["unknown key"],
    ),
    (lambda: ROOM.with_obstacle("ball", Body(shape=SPHERE)), "obstacles.ball", ["same name"]),
    (lambda: ROOM.with_obstacle("box", 3), "obstacles.box", ["a Body, or a dict"]),  # type: ignore[arg-type]
    (lambda: ROOM.with_object("box", Body(shape=SPHERE)), "objects.box", ["an Object, or a dict"]),  # type: ignore[arg-type]
    (lambda: ROOM.with_object_pose("ball", np.eye(3)), "pose", ["(4, 4)"]),
    (lambda: HOLD.model_copy(update={"lock": {"x": "nonsense"}}), "lock.x", ["a number", "'nonsense'"]),
    (lambda: HOLD.model_copy(update={"lokc": {}}), "lokc", ["Did you mean lock"]),
    (lambda: Pose().model_copy(update={"position": (0.0, NAN, 0.0)}), "position[1]", ["finite"]),
    (lambda: Scene(**MADE, source="made_up.yaml"), "source", ["unknown key", "Remove it"]),
    (lambda: Scene(**MADE, source=None), "source", ["unknown key"]),
    (lambda: Scene(**MADE, digest="00"), "digest", ["unknown key", "Remove it"]),
    (lambda: ROOM.model_copy(update={"source": "made_up.yaml"}), "source", ["unknown key"]),
    (lambda: ROOM.model_copy(update={"digest": "00"}), "digest", ["unknown key"]),
    (lambda: Scene.from_dict([]), "data", ["a mapping of keys"]),  # type: ignore[arg-type]
    (lambda: Scene.from_dict({}), "format", ["missing"]),
    (lambda: Scene.from_dict({**ROOM.to_dict(), "format": 2}), "format", ["must be 1 (given: 2)"]),
    (lambda: Scene.from_dict({"fromat": 1}), "fromat", ["Did you mean format"]),
    (lambda: Scene.from_dict({**ROOM.to_dict(), "digest": ""}), "digest", ["unknown key"]),
    (lambda: Scene.from_dict({**ROOM.to_dict(), 3: 1}), "3", ["string"]),
]


@pytest.mark.parametrize(("make", "key", "words"), BAD, ids=lambda value: None if callable(value) else str(value)[:40])
def test_bad_value(make: Callable[[], object], key: str, words: list[str]) -> None:
    error = refused(make)
    assert error.key == key
    for word in words:
        assert word in str(error)


@pytest.mark.parametrize(
    ("make", "key", "words"),
    [
        (lambda: ROOM.task("hodl"), "tasks", "no task 'hodl' in this scene. Did you mean hold?"),
        (lambda: ROOM.task(["hold"]), "tasks", "no task ['hold'] in this scene. Did you mean hold?"),  # type: ignore[arg-type]
        (lambda: ROOM.with_task("hodl", lock={}), "tasks", "Did you mean hold?"),
        (lambda: ROOM.with_task("hold", object="bal"), "tasks.hold.object", "no object 'bal' is defined. Did you mean"),
        (lambda: ROOM.with_object_pose("bal", Pose()), "objects", "Did you mean ball?"),
        (lambda: ROOM.model_copy(update={"objects": {}}), "tasks.hold.object", "no object 'ball' is defined. None is"),
        (lambda: ROOM.objects["bal"], None, "Did you mean ball?"),
    ],
)
def test_unknown_name(make: Callable[[], object], key: str | None, words: str) -> None:
    error = refused(make)
    assert isinstance(error, UnknownNameError)
    assert isinstance(error, KeyError)
    assert error.key == key
    assert words in str(error)


def test_what_only_the_plan_shows_names_no_file_either(gen3: Robot) -> None:
    outside = ROOM.with_object_pose("ball", Pose(position=(2.0, 0.0, 0.0)))
    error = refused(lambda: check_placement(outside, "hold"))
    assert (type(error), error.key) == (TaskError, "objects.ball.pose")
    error = refused(lambda: TaskModel(gen3, ROOM.with_task("hold", pads=("left", "rihgt")), "hold"))
    assert (type(error), error.key) == (UnknownNameError, "tasks.hold.pads[1]")


# ---- types

SCRIPT = """
import numpy as np

import pinograsp
from pinograsp import Body, Box, ContactConstants, Enclosure, Object, Pose, Scene, Sphere, Task, Wrench


corner = np.array([1.0, 0.4, 0.4])
scene = Scene(
    name="room",
    enclosure=Enclosure(min=(0, -0.4, -0.3), max=tuple(corner)),
    objects={"ball": Object(shape=Sphere(radius=0.04), pose=Pose(position=(0.8, 0.0, -0.1)))},
    tasks={
        "hold": Task(
            object="ball",
            desired_contacts=((0.0, 0.04, 0.0), (0.0, -0.04, 0.0)),
            wrench=Wrench(force=(0.0, 0.0, -1.0)),
            contact=ContactConstants(friction=0.9),
            lock={"joint_7": 0.0},
            joint_ranges={"joint_6": (-1.5, 0.5)},
        )
    },
)
scene = scene.with_obstacle("box", Body(shape=Box(size=(0.1, 0.1, 0.1))))
scene = scene.with_object_pose("ball", np.eye(4)).with_task("hold", force_weight=2.0)
radius: float = scene.objects["ball"].pose.position[0]
for name, body in scene.obstacles.items():
    print(name, body.pose.matrix[0, 3] + radius)
"""
WRONG = {
    "Sphere(raduis=0.04)": "Unexpected keyword argument",
    'Sphere(radius="x")': "incompatible type",
    "Sphere()": "Missing named argument",
    'scene.objects["x"] = scene.objects["ball"]': "Unsupported target for indexed assignment",
    'Scene(name="x", source="y")': "Unexpected keyword argument",
}


@pytest.mark.slow
def test_a_strict_script_passes_without_a_plugin(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(SCRIPT)
    (tmp_path / "wrong.py").write_text(SCRIPT + "\n".join(WRONG) + "\n")
    config = tmp_path / "mypy.ini"
    config.write_text("[mypy]\nstrict = True\n")
    command = [sys.executable, "-m", "mypy", "--config-file", str(config), "--follow-imports", "silent"]
    good, bad = (
        subprocess.run([*command, str(tmp_path / name)], capture_output=True, text=True, check=False)
        for name in ("script.py", "wrong.py")
    )
    assert (good.returncode, good.stdout.splitlines()[-1]) == (0, "Success: no issues found in 1 source file")
    first = SCRIPT.count("\n") + 1
    for line, words in enumerate(WRONG.values(), first):
        assert any(f"wrong.py:{line}:" in text and words in text for text in bad.stdout.splitlines()), bad.stdout


def test_a_notebook_shows_bodies_and_tasks() -> None:
    scene = load_scene("glovebox_can").with_obstacle("lamp", Body(shape=Box(size=(0.1, 0.2, 0.3))))
    html = scene._repr_html_()
    text = re.sub(r"(<[^>]*>)+", "|", html)
    assert "|Scene glovebox_can: enclosure from (0, -0.42, -0.237) to (1.1, 0.42, 0.363) m|" in text
    assert "|can|object|cylinder, radius 0.0423, height 0.118|(0.997, 0.02, -0.178)|" in text
    assert "|lamp|obstacle|box, size (0.1, 0.2, 0.3)|(0, 0, 0)|" in text
    assert "|can_region|can|(0, 0, -2)|0.9|" in text


def test_parts_taken_away() -> None:
    scene = load_scene("glovebox")
    post = Body(shape=Sphere(radius=0.01), pose=Pose(position=(0.3, 0.2, 0.1)))
    assert scene.with_obstacle("post", post).without_obstacle("post") == scene
    assert scene.with_object("post", Object(shape=Sphere(radius=0.01))).without_object("post") == scene
    assert scene.with_task("again", scene.task("sphere")).without_task("again") == scene
    held = scene.task("sphere").object
    with pytest.raises(InputError, match=rf"^objects\.{held}: task 'sphere' is about it\. Take that away first"):
        scene.without_object(held)
    assert held not in scene.without_task("sphere").without_object(held).objects


@pytest.mark.parametrize("what", ["object", "obstacle", "task"])
def test_what_is_not_there_cannot_be_taken_away(what: str) -> None:
    scene = load_scene("glovebox")
    with pytest.raises(UnknownNameError, match=rf"{what}s: no {what} 'nothing' in this scene"):
        getattr(scene, f"without_{what}")("nothing")


def test_the_page_about_scenes_runs() -> None:
    """Its Python, in the order of the page; what it shows from a file has tests of its own."""
    page = (Path(__file__).parents[1] / "docs" / "howto" / "scene_in_python.md").read_text()
    known: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL):
        if "--8<--" not in block:
            exec(block, known)
    turned = known["turned"]
    np.testing.assert_allclose(turned.rpy, (0.0, 0.0, math.pi / 4), atol=1e-7)
    assert turned.position == (0.5, 0.0, 0.035)
