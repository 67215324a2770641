"""Arguments of public calls that cannot be used: errors of pinograsp, which name the argument."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pinograsp
from pinograsp import (
    Coverage,
    Database,
    DirectionCone,
    Errors,
    HoldOptions,
    InputError,
    Planner,
    Robot,
    Scene,
    SolverOptions,
    TaskError,
    UnknownNameError,
    assess,
    build_database,
    configurations_near,
    hold_test,
    load_robot,
    load_scene,
    plan,
    read_json,
    schema,
    spread_configurations,
    verify,
    visualization,
    write_json,
)
from pinograsp.results.different import different
from pinograsp.results.ranking import pareto_front

NAN = float("nan")
ALONE: list[tuple[Callable[[], object], str | None, list[str]]] = [
    (lambda: load_scene(3), None, ["a path or a name is wanted, not 3"]),  # type: ignore[arg-type]
    (lambda: load_robot(None), None, ["a path or a name is wanted, not None"]),  # type: ignore[arg-type]
    (lambda: load_scene("a" * 5000), None, ["no such scene file"]),
    (lambda: load_robot("a\0b"), None, ["no such robot file"]),
    (lambda: load_scene(""), None, ["a path or a name is wanted, not ''"]),
    (lambda: load_robot(""), None, ["a path or a name is wanted, not ''"]),
    (lambda: load_scene(Path(__file__).parent), None, ["tests: is a folder, not a scene file. Name a scene file"]),
    (lambda: load_robot(Path(__file__).parent), None, ["tests: is a folder without robot.yaml"]),
    (lambda: Database.open(Path(__file__).parent), None, ["tests: is a folder"]),
    (lambda: schema("scenes"), "kind", ["Did you mean scene?"]),  # type: ignore[arg-type]
    (lambda: schema([]), "kind", ["Known: robot, scene"]),  # type: ignore[arg-type]
    (lambda: SolverOptions(tries=0), "tries", ["at least 1"]),
    (lambda: SolverOptions(tries="x"), "tries", ["a whole number"]),  # type: ignore[arg-type]
    (lambda: SolverOptions(max_evaluations=-3), "max_evaluations", ["at least 1"]),
    (lambda: SolverOptions(tolerance=NAN), "tolerance", ["finite"]),
    (lambda: SolverOptions(projection="contact"), "projection", ["Did you mean contacts?"]),  # type: ignore[arg-type]
    (lambda: SolverOptions(algorithm="SLSQP"), "algorithm", ["Did you mean LD_SLSQP?"]),
    (lambda: SolverOptions(algorithm=[]), "algorithm", ["Known: "]),  # type: ignore[arg-type]
    (lambda: HoldOptions(friction="x"), "friction", ["a number"]),  # type: ignore[arg-type]
    (lambda: HoldOptions(spin=NAN), "spin", ["finite"]),
    (lambda: HoldOptions(ramp=0.0), "ramp", ["positive"]),
    (lambda: HoldOptions(slip_angle=True), "slip_angle", ["must be a number, not True"]),
    (lambda: HoldOptions(friction=-0.5), "friction", ["must be positive, not -0.5"]),
    (lambda: HoldOptions(control="hand"), "control", ["is not auto, torque or position"]),  # type: ignore[arg-type]
    (lambda: HoldOptions(acceleration="3"), "acceleration", ["must be a number, not '3'"]),  # type: ignore[arg-type]
    (lambda: SolverOptions(tries=True), "tries", ["must be a whole number, not True"]),
    (lambda: Errors(position=-0.005), "position", ["must be at least 0 m, not -0.005"]),
    (lambda: Errors(orientation=4.0), "orientation", ["must be at most 3.14159 rad, not 4"]),
    (lambda: Errors(joint=True), "joint", ["must be a number, not True"]),
    (lambda: Errors(weight=(0.9, NAN)), "weight", ["finite"]),
    (lambda: DirectionCone("x", 1.0), "axis", ["numbers of shape (3,)"]),  # type: ignore[arg-type]
    (lambda: DirectionCone(np.zeros(3), 1.0), "axis", ["no direction"]),
    (lambda: DirectionCone(np.ones(2), 1.0), "axis", ["shape (2,), not (3,)"]),
    (lambda: DirectionCone(np.array([0.0, 0.0, NAN]), 1.0), "axis", ["not finite"]),
    (lambda: DirectionCone(np.ones(3), 4.0), "half_angle", ["at most 3.14"]),
    (lambda: read_json(3), "file", ["must be of class Path or str, not 3"]),  # type: ignore[arg-type]
    (lambda: Database.open(None), "file", ["must be of class Path or str"]),  # type: ignore[arg-type]
    (lambda: assess(3), "grasp", ["must be of class Grasp, not 3"]),  # type: ignore[arg-type]
    (lambda: hold_test(3), "grasps", ["must be of class Result or Grasp"]),  # type: ignore[arg-type]
    (lambda: hold_test([3]), "grasps", ["must be of class Grasp"]),  # type: ignore[list-item]
    (lambda: hold_test([], options={"spin": 1.0}), "options", ["must be of class HoldOptions"]),  # type: ignore[arg-type]
    *((lambda count=count: hold_test([], workers=count), "workers", ["at least 1"]) for count in (0, -3)),
    (lambda: hold_test([], workers=1.5), "workers", ["a whole number"]),  # type: ignore[arg-type]
    (lambda: pinograsp.write_mjcf(3, "hand.xml"), "grasp", ["must be of class Grasp, not 3"]),  # type: ignore[arg-type]
    (lambda: pinograsp.write_film(3, "hand.gif"), "grasp", ["must be of class Grasp, not 3"]),  # type: ignore[arg-type]
    (lambda: pinograsp.write_film(3, 3), "file", ["must be of class Path or str"]),  # type: ignore[arg-type]
    (lambda: visualization.write_robot_html("toy", "toy.html"), "robot", ["load_robot"]),  # type: ignore[arg-type]
    (lambda: Robot("gen3_2f85"), "description", ["must be of class RobotDescription", "load_robot"]),  # type: ignore[arg-type]
    (lambda: Coverage.of(3), "database", ["must be of class Database, not 3"]),  # type: ignore[arg-type]
    (lambda: configurations_near(3, [0, 0, 0], 1.0), "database", ["must be of class Database"]),  # type: ignore[arg-type]
    (lambda: visualization.coverage_png(3, "a.png", ""), "coverage", ["must be of class Coverage"]),  # type: ignore[arg-type]
    (lambda: visualization.coverage_html(3, "a.html", ""), "coverage", ["Coverage.of"]),  # type: ignore[arg-type]
    (lambda: verify(3), "result", ["must be of class Result, not 3", "read_json"]),  # type: ignore[arg-type]
    (lambda: write_json(3, "result.json"), "result", ["must be of class Result, not 3"]),  # type: ignore[arg-type]
    (lambda: visualization.write_html(3, "page.html"), "grasp", ["must be of class Grasp"]),  # type: ignore[arg-type]
    (lambda: hold_test([], progress=3), "progress", ["must be a function, not 3"]),  # type: ignore[arg-type]
    (lambda: SolverOptions(max_evaluations=2**31), "max_evaluations", ["at most 2147483647"]),
    (lambda: SolverOptions(tries=2**53), "tries", ["at most 9007199254740991"]),
    (lambda: different([], -1), "most", ["at least 0"]),
    (lambda: pareto_front([], 3), "criteria", ["must be of class Sequence"]),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("call", "key", "words"), ALONE)
def test_alone(call: Callable[[], object], key: str | None, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        call()
    assert caught.value.key == key
    for word in words:
        assert word in str(caught.value)


PLANS: list[tuple[dict[str, Any], str, list[str]]] = [
    ({"robot": "gen3_2f85"}, "robot", ["must be of class Robot, not 'gen3_2f85'", "load_robot"]),
    ({"scene": "glovebox"}, "scene", ["must be of class Scene, not 'glovebox'", "load_scene"]),
    ({"task": "spher"}, "tasks", ["Did you mean sphere?"]),
    ({"task": None}, "tasks", ["no task None"]),
    ({"starts": 1.5}, "starts", ["a whole number"]),
    ({"starts": 0}, "starts", ["at least 1"]),
    ({"starts": 10**30}, "starts", ["at most 9007199254740991"]),
    (
        {"task": load_scene("glovebox").tasks["sphere"]},
        "tasks",
        ["no task Task(object=", "in this scene. Known: sphere"],
    ),
    ({"progress": 3}, "progress", ["must be a function, not 3", "pinograsp.Progress"]),
    ({"seed": -1}, "seed", ["at least 0"]),
    ({"workers": 0}, "workers", ["at least 1"]),
    ({"workers": True}, "workers", ["a whole number"]),
    ({"database": 3}, "database", ["must be of class Database or Path or str"]),
    ({"options": {"tries": 1}}, "options", ["must be of class SolverOptions"]),
]


@pytest.mark.parametrize(("changes", "key", "words"), PLANS)
def test_a_plan(gen3: Robot, glovebox: Scene, changes: dict[str, Any], key: str, words: list[str]) -> None:
    given = {"robot": gen3, "scene": glovebox, "task": "sphere", "starts": 1, "workers": 1} | changes
    with pytest.raises(InputError) as caught:
        plan(**given)
    assert caught.value.key == key
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize("given", ["grasp", "result"])
def test_a_configuration_that_is_a_grasp(gen3: Robot, glovebox: Scene, given: str) -> None:
    result = plan(gen3, glovebox, "sphere", starts=4, workers=1)
    wrong: Any = result.best if given == "grasp" else result
    with pytest.raises(InputError, match=rf"^joints: must be values of joints, not a {given.title()}. Give .*joints`"):
        pinograsp.check(gen3, glovebox, "sphere", wrong)


@pytest.mark.parametrize("deadline", ["x", NAN, -1.0])
def test_a_deadline(gen3: Robot, glovebox: Scene, deadline: Any) -> None:
    with Planner(gen3, glovebox, workers=1) as planner, pytest.raises(InputError, match=r"^deadline: must be"):
        next(planner.grasps("sphere", deadline=deadline))


@pytest.fixture(scope="module")
def rows(toy: Robot, tmp_path_factory: pytest.TempPathFactory, make_toy_scene: Any) -> Database:
    return build_database(toy, make_toy_scene(), tmp_path_factory.mktemp("rows") / "rows.duckdb", size=200, workers=1)


QUERIES: list[tuple[dict[str, Any], str, list[str]]] = [
    ({"center": "x"}, "center", ["numbers of shape (3,)"]),
    ({"center": [0.0, 0.0]}, "center", ["shape (2,), not (3,)"]),
    ({"center": [0.0, 0.0, NAN]}, "center", ["not finite"]),
    ({"extent": -1.0}, "extent", ["at least 0"]),
    ({"extent": [1.0, 1.0]}, "extent", ["shape (2,), not (3,)"]),
    ({"extent": "x"}, "extent", ["numbers"]),
    ({"cone": 3}, "cone", ["must be of class DirectionCone"]),
    ({"joints": {"sholder": [(0.0, 1.0)]}}, "joints", ["there is no arm joint 'sholder'. Did you mean shoulder?"]),
]


@pytest.mark.parametrize(("changes", "key", "words"), QUERIES)
def test_a_query(rows: Database, changes: dict[str, Any], key: str, words: list[str]) -> None:
    given = {"center": [0.0, 0.0, 0.1], "extent": 0.5} | changes
    for call in (configurations_near, lambda *a, **k: spread_configurations(*a, 5, **k)):
        with pytest.raises(InputError) as caught:
            call(rows, given["center"], given["extent"], **{k: v for k, v in given.items() if k in {"cone", "joints"}})
        assert caught.value.key == key
        for word in words:
            assert word in str(caught.value)
        assert isinstance(caught.value, UnknownNameError) == (key == "joints")


def test_numbers_of_a_query(rows: Database) -> None:
    for voxel in (0.0, -0.1, NAN):
        with pytest.raises(InputError, match=r"^voxel: must be"):
            Coverage.of(rows, voxel)
    for voxel in (1e-9, 1e-300):
        with pytest.raises(InputError, match=r"^voxel: is too small: the enclosure would have more than 100,000,000"):
            Coverage.of(rows, voxel)
    with pytest.raises(InputError, match=r"^limit: must be at least 0"):
        configurations_near(rows, np.zeros(3), 0.5, limit=-1)
    with pytest.raises(InputError, match=r"^limit: must be at most 9007199254740991"):
        configurations_near(rows, np.zeros(3), 0.5, limit=10**30)
    with pytest.raises(InputError, match=r"^count: must be at most 9007199254740991"):
        spread_configurations(rows, np.zeros(3), 0.5, 10**30)
    with pytest.raises(InputError, match=r"^count: must be at least 0"):
        spread_configurations(rows, np.zeros(3), 0.5, -1)
    with pytest.raises(InputError, match=r"^seed: must be a whole number"):
        spread_configurations(rows, np.zeros(3), 0.5, 5, seed="x")  # type: ignore[arg-type]


def test_seeds_of_any_size(rows: Database) -> None:
    """Those above 2147 used to overflow DuckDB's integers."""
    chosen = {
        seed: tuple(spread_configurations(rows, np.zeros(3), 1.0, 5, seed=seed).samples.tolist())
        for seed in (0, 1, 2147, 2148, 10**6, 2**31, 2**70)
    }
    assert len(set(chosen.values())) >= 6


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"size": 0}, "size"),
        ({"size": 10**30}, "size"),
        ({"progress": 3}, "progress"),
        ({"seed": -1}, "seed"),
        ({"spread": "joint"}, "spread"),
        ({"workers": 0}, "workers"),
        ({"margins": 0.01}, "margins"),
    ],
)
def test_a_database(toy: Robot, make_toy_scene: Any, tmp_path: Path, changes: dict[str, Any], key: str) -> None:
    with pytest.raises(InputError) as caught:
        build_database(toy, make_toy_scene(), tmp_path / "rows.duckdb", **{"size": 10, **changes})
    assert caught.value.key == key
    assert not (tmp_path / "rows.duckdb").exists()


def test_errors_are_public() -> None:
    assert issubclass(TaskError, pinograsp.PinograspError)
