"""Commands on results and on configurations of the user's own, against what Python says of the same."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from conftest import Run

import pinograsp
from pinograsp import Result, Robot, Scene
from pinograsp.cli import folders
from pinograsp.interrupts import held

NAMES = "glovebox_sphere_gen3_2f85"
HAND = "robotiq_85_left_knuckle_joint"


@pytest.fixture(scope="module")
def result(gen3: Robot, glovebox: Scene) -> Result:
    return pinograsp.plan(gen3, glovebox, "sphere", starts=12, workers=1)


@pytest.fixture(scope="module")
def file(result: Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    written = tmp_path_factory.mktemp("results") / "result.json"
    pinograsp.write_json(result, written)
    return written


def refused(outcome: tuple[int, str, str]) -> str:
    """Require exit code 2, one line of error and nothing else; return the line."""
    code, output, errors = outcome
    assert (code, output, errors.count("\n")) == (2, "", 1)
    assert errors.startswith("error: ")
    return errors


# ---- rank


def rows(output: str) -> list[int]:
    """Return the numbers of the grasps in a table, in its order."""
    return [int(line.split()[0]) for line in output.splitlines() if re.match(r" *\d+ +\d+x ", line)]


def numbers(result: Result, grasps: tuple[pinograsp.Grasp, ...]) -> list[int]:
    of = {id(grasp): number for number, grasp in enumerate(result.grasps, 1)}
    return [of[id(grasp)] for grasp in grasps]


@pytest.mark.parametrize("by", ["score", "U", "clearance", "contact gap"])
def test_rank(run: Run, result: Result, file: Path, by: str) -> None:
    code, output, errors = run("rank", file, "--by", by, "--all")
    assert (code, errors) == (0, "")
    assert rows(output) == numbers(result, result.ranked(by))
    assert f"by {by}" in " ".join(output.split())
    code, output, _ = run("rank", file, "--by", by, "--different", 3)
    assert rows(output) == numbers(result, tuple(shown.grasp for shown in result.different(3, by)))


def test_rank_of_the_front(run: Run, result: Result, file: Path) -> None:
    front = result.pareto(["clearance", "joint reserve", "manipulability"])
    assert 1 < len(front) < len(result.grasps)
    for options in (
        ["--pareto", "clearance,joint reserve, manipulability"],
        ["--pareto", "clearance,joint reserve", "--pareto", "manipulability"],
    ):
        code, output, _ = run("rank", file, *options, "--all")
        assert code == 0
        assert rows(output) == numbers(result, front)
        assert "front of clearance, joint reserve, manipulability" in " ".join(output.split())


def test_rank_page(run: Run, file: Path, tmp_path: Path) -> None:
    code, output, errors = run("rank", file, "--by", "joint reserve", "--out", "pages")
    assert (code, errors) == (0, "")
    page = tmp_path / "pages" / f"{NAMES}_by_joint_reserve.html"
    assert output.endswith(f"written: pages/{page.name}\n")
    assert "joint reserve" in page.read_text()
    assert "--pareto: is given with --out" in refused(run("rank", file, "--pareto", "U", "--out", "pages"))


def test_rank_as_json(run: Run, result: Result, file: Path) -> None:
    code, output, errors = run("rank", file, "--by", "clearance", "--different", 2, "--json")
    assert (code, errors) == (0, "")
    found = json.loads(output)
    assert {key: found[key] for key in ("robot", "scene", "task", "by", "pareto")} == {
        "robot": "gen3_2f85",
        "scene": "glovebox",
        "task": "sphere",
        "by": "clearance",
        "pareto": [],
    }
    expected = result.different(2, "clearance")
    assert [(shown["starts"], shown["grasp_count"]) for shown in found["ranked"]] == [shown[1:] for shown in expected]
    assert [shown["grasp"] for shown in found["ranked"]] == [shown.grasp.to_json() for shown in expected]
    assert [shown["number"] for shown in found["ranked"]] == numbers(result, tuple(s.grasp for s in expected))
    code, output, _ = run("rank", file, "--by", "U", "--all", "--json")
    every = json.loads(output)["ranked"]
    assert [shown["number"] for shown in every] == numbers(result, result.ranked("U"))
    assert [(shown["starts"], shown["grasp_count"]) for shown in every] == [(g.count, 1) for g in result.ranked("U")]


def test_rank_by_what_there_is_not(run: Run, file: Path) -> None:
    wrong = "no criterion and no figure is called"
    assert f"--by: {wrong} 'clearence'. Did you mean clearance" in refused(run("rank", file, "--by", "clearence"))
    assert f"--pareto: {wrong} 'beauty'. Known: " in refused(run("rank", file, "--pareto", "U,beauty"))
    assert "--pareto: no criterion is named. Known: U, Q_force" in refused(run("rank", file, "--pareto", ""))
    assert "nosuch.json: cannot be read: no such file or directory" in refused(run("rank", "nosuch.json"))


def test_rank_of_nothing(run: Run, result: Result, tmp_path: Path) -> None:
    from dataclasses import replace

    pinograsp.write_json(replace(result, grasps=()), tmp_path / "none.json")
    code, output, _ = run("rank", "none.json")
    assert (code, output) == (1, "The result has no grasp.\n")


# ---- Ctrl-C


@pytest.mark.parametrize(
    ("command", "ending"),
    [
        (("plan", "glovebox", "--task", "sphere", "--starts", 4, "--workers", 1), ("json", "html")),
        (("assess", "{file}", "--samples", 2, "--workers", 1, "--out", "out"), ("assessment.json",)),
        (("hold", "{file}", "--grasp", 1, "--workers", 1, "--out", "out"), ("hold.json",)),
        (("check", "glovebox", "--task", "sphere", "--joints", "{joints}", "--out", "out"), ("json", "html")),
        (("robot", "check", "gen3_2f85"), ("check.html",)),
        (("database", "coverage", "{database}", "--png", "--html"), ("coverage.png", "coverage.html")),
    ],
    ids=lambda part: part[0],
)
def test_ctrl_c_after_the_work_comes_after_the_files(
    run: Run,
    file: Path,
    result: Result,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    command: tuple[object, ...],
    ending: tuple[str, ...],
) -> None:
    joints = tmp_path / "joints.json"
    joints.write_text(json.dumps(dict(result.grasps[0].joints)))
    places = {"file": file, "joints": joints, "database": result.provenance["database"]["file"]}

    @contextmanager
    def pressed() -> Iterator[None]:
        with held():
            os.kill(os.getpid(), signal.SIGINT)
            yield

    monkeypatch.setattr(folders, "held", pressed)
    code, output, errors = run(*(str(word).format(**places) for word in command))
    assert (code, output, errors) == (130, "", "error: interrupted\n")
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert len(written) == len(ending)
    assert all(any(name.endswith(end) for name in written) for end in ending)


# ---- show


def test_show(run: Run, result: Result, file: Path, tmp_path: Path) -> None:
    grasp = result.grasps[1]
    code, output, errors = run("show", file, "--grasp", 2, "--out", "pages")
    assert (code, errors) == (0, "")
    assert output.startswith(f"grasp 2 of {len(result.grasps)}: sphere, gen3_2f85 in glovebox; found by ")
    assert f"U {grasp.cost.U:.4f}: " in output
    for name, value in grasp.joints.items():
        assert re.search(rf"^  {re.escape(name)} +{value:.4f}$", output, flags=re.MULTILINE)
    for contact in grasp.contacts:
        assert re.search(rf"^{contact.pad} .* {1e3 * contact.point[0]:.1f} ", output, flags=re.MULTILINE)
        assert f" {contact.force[1]:.2f} " in output
    for figure in grasp.certificate.figures:
        assert figure.name in output
        assert figure.shown_value in output
    page = tmp_path / "pages" / f"{NAMES}_grasp2.html"
    assert output.endswith(f"written: pages/{page.name}\n")
    assert "<html" in page.read_text()[:1000].lower()


def test_show_as_json(run: Run, result: Result, file: Path) -> None:
    code, output, _ = run("show", file, "--json")
    names = {"robot": "gen3_2f85", "scene": "glovebox", "task": "sphere", "number": 1}
    assert code == 0
    assert json.loads(output) == names | {"grasp": result.grasps[0].to_json()}


def test_show_what_there_is_not(run: Run, file: Path) -> None:
    assert f"--grasp: no grasp 99: there are {12}" in refused(run("show", file, "--grasp", 99))
    assert "--open: needs a page. Give the folder of the page with --out" in refused(run("show", file, "--open"))


# ---- check


@pytest.fixture
def posture(result: Result, tmp_path: Path) -> Path:
    """Return a file with the joints of the best grasp."""
    written = tmp_path / "posture.json"
    written.write_text(json.dumps(dict(result.grasps[0].joints)))
    return written


def test_check_of_a_grasp(
    run: Run, gen3: Robot, glovebox: Scene, result: Result, posture: Path, tmp_path: Path
) -> None:
    code, output, errors = run("check", "glovebox", "--task", "sphere", "--joints", posture, "--out", "out")
    assert (code, errors) == (0, "")
    expected = pinograsp.check(gen3, glovebox, "sphere", result.grasps[0].joints)
    assert expected.verified
    for figure in expected.certificate.figures:
        assert figure.name in output
    assert f"{1e3 * expected.clearances[-1].distance:.1f}" in output
    assert "\nverified\n" in output
    files = [f"out/{NAMES}_check.{suffix}" for suffix in ("json", "html")]
    assert output.endswith("".join(f"written: {file}\n" for file in files))
    names = {"robot": "gen3_2f85", "scene": "glovebox", "task": "sphere"}
    assert json.loads((tmp_path / files[0]).read_text()) == names | expected.to_json()
    code, output, errors = run("check", "glovebox", "--task", "sphere", "--joints", posture, "--json")
    assert (code, errors) == (0, "")
    assert json.loads(output) == names | expected.to_json()


def test_check_of_no_grasp(run: Run, gen3: Robot, glovebox: Scene, result: Result, posture: Path) -> None:
    """Values that come later count."""
    joints = result.grasps[0].joints
    moved = {**joints, "joint_2": joints["joint_2"] + 0.5, "joint_4": 0.25}
    expected = pinograsp.check(gen3, glovebox, "sphere", moved)
    values = f"joint_2={moved['joint_2']!r}"
    options = ["--joints", posture, "--joints", values, "--joints", "joint_4=0.25"]
    code, output, _ = run("check", "glovebox", "--task", "sphere", *options, "--json")
    assert code == 1
    assert json.loads(output).items() >= expected.to_json().items()
    code, output, _ = run("check", "glovebox", "--task", "sphere", *options)
    assert code == 1
    refuting = ", ".join(figure.name for figure in expected.certificate.refuted_by)
    assert output.endswith(f"\nnot verified: {refuting}\n")
    failing = [line.split()[0] == "!" for line in output.splitlines() if "contact gap" in line and "not" not in line]
    assert failing == [True]


def test_check_of_a_whole_grasp(run: Run, result: Result, file: Path, tmp_path: Path) -> None:
    """A grasp as `show --json` or Python writes it holds its joints."""
    (tmp_path / "grasp.json").write_text(json.dumps(result.grasps[0].to_json()))
    (tmp_path / "shown.json").write_text(run("show", file, "--json")[1])
    assert run("check", "glovebox", "--task", "sphere", "--joints", "shown.json", "--quiet") == (0, "", "")
    assert run("check", "glovebox", "--task", "sphere", "--joints", "grasp.json", "--quiet") == (0, "", "")


@pytest.mark.parametrize("name", ["a,b.json", "best=1.json", "runs=2/joint_1=0.5"])
def test_files_of_joints_with_signs_in_their_names(run: Run, result: Result, name: str, tmp_path: Path) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text(json.dumps(dict(result.grasps[0].joints)))
    assert run("check", "glovebox", "--task", "sphere", "--joints", name, "--quiet") == (0, "", "")


@pytest.mark.parametrize(
    ("joints", "words"),
    [
        ("runs=2/nosuch.json", "runs=2/nosuch.json: cannot be read: no such file or directory"),
        ("joint_1=1.0,joint_2=1.0", "--joints: 'joint_1=1.0,joint_2=1.0' is not JOINT=VALUE"),
        ("=1.0", "--joints: '=1.0' is not JOINT=VALUE"),
        ("nosuch.json", "nosuch.json: cannot be read: no such file or directory. Check the path"),
        ("broken.json", "broken.json: is not valid JSON"),
        ("list.json", 'list.json: --joints: values by the names of joints are wanted. Write, for example, {"shoulder"'),
        ("words.json", 'words.json: joint_1: a number is wanted, not "up"'),
        ("result.json", "result.json: --joints: is a result: one grasp is wanted. pinograsp show RESULT --json gives"),
        ("joint_1=up", "--joints: 'joint_1=up' is not JOINT=VALUE"),
        ("joint_1=nan", "--joints: 'joint_1=nan' is not JOINT=VALUE"),
        ("joint_1=1.0", "--joints: no value is given for 'joint_2'"),
        ("joint_99=1.0", "--joints: there is no joint 'joint_99'"),
    ],
)
def test_joints_that_cannot_be_used(run: Run, joints: str, words: str, tmp_path: Path) -> None:
    for name, text in (
        ("broken", "{"),
        ("list", "[1.0]"),
        ("words", '{"joint_1": "up"}'),
        ("result", '{"grasps": []}'),
    ):
        (tmp_path / f"{name}.json").write_text(text)
    assert words in refused(run("check", "glovebox", "--task", "sphere", "--joints", joints))


# ---- numbers out of range: errors name the option, and the number as it was given


@pytest.mark.parametrize(
    ("command", "options", "words"),
    [
        ("assess", ["--position", -5], "--position -5.0 mm: must be"),
        ("assess", ["--orientation", 190], "--orientation 190.0°: must be"),
        ("assess", ["--center-of-mass", 2000], "--center-of-mass 2000.0 mm: must be"),
        ("assess", ["--joint", -1], "--joint -1.0 mrad: must be"),
        ("assess", ["--friction", 0.9, 0.5], "--friction: the least, 0.9, is above the greatest, 0.5"),
        ("assess", ["--weight", -1, 1], "--weight: must be"),
        ("assess", ["--samples", 10**9], "--samples: must be at most "),
        ("hold", ["--acceleration", -1], "--acceleration: must be at least 0, not -1"),
        ("hold", ["--spin", "nan"], "--spin: must be a finite number"),
        ("hold", ["--slip-distance", 0], "--slip-distance 0.0 mm: must be positive"),
        ("hold", ["--slip-angle", -1], "--slip-angle -1.0°: must be positive"),
        ("hold", ["--strongest", 0], "--strongest: must be positive"),
        ("hold", ["--friction", 0], "--friction: must be positive"),
        ("hold", ["--control", "force"], "--control: 'force' is not auto, torque or position"),
    ],
    ids=lambda value: " ".join(map(str, value)) if isinstance(value, list) else "",
)
def test_numbers_out_of_range(run: Run, file: Path, command: str, options: list[object], words: str) -> None:
    assert refused(run(command, file, *options)).startswith(f"error: {words}")


def test_directions_out_of_range(run: Run) -> None:
    options = ("nosuch.duckdb", "--center", 0.8, 0, 0, "--cone")
    assert "error: --angle 300°: must be at most 3.14159 rad, not 5.23599" in refused(
        run("database", "query", *options, 0, 0, 1, "--angle", 300)
    )
    assert "error: --cone: has no direction: its length is 0" in refused(run("database", "query", *options, 0, 0, 0))


def test_queries_that_make_no_sense(run: Run, result: Result) -> None:
    query = ("database", "query", result.provenance["database"]["file"], "--center", 0.8, 0, 0)
    for options, words in (
        (["--joint", "joint_1=1"], "--joint: 'joint_1=1' is not JOINT=LEAST,MOST. Give, for example, elbow=-0.5,0.5"),
        (["--joint", "joint_1=1,0"], "--joint: 1 .. 0 is no interval of joint_1"),
        (["--joint", "joint_0=0,1"], "--joint: there is no arm joint 'joint_0'. Did you mean joint_"),
        (["--box", 0.1, -0.1, 0.1], "--box: must be at least 0, not -0.1"),
        (["--box", 0.1, 0.1, 0.1, "--radius", 0.1], "--box: is given with --radius. Give one of them"),
    ):
        assert refused(run(*query, *options)).startswith(f"error: {words}")


# ---- hold


def test_hold_with_every_option(run: Run, result: Result, file: Path) -> None:
    options = pinograsp.HoldOptions(
        acceleration=3.0,
        spin=4.0,
        slip_distance=0.5e-3,
        slip_angle=math.radians(1.0),
        first_slip=True,
        ramp=40.0,
        strongest=4.0,
        control="position",
        squeeze=False,
        friction=0.8,
    )
    (expected,) = pinograsp.hold_test(result.grasps[0], options=options, workers=1)
    loads = ("--acceleration", 3, "--spin", 4, "--first-slip", "--ramp", 40, "--strongest", 4)
    limits = ("--slip-distance", 0.5, "--slip-angle", 1, "--control", "position", "--no-squeeze", "--friction", 0.8)
    _, output, _ = run("hold", file, "--grasp", 1, "--workers", 1, *loads, *limits, "--json")
    (found,) = json.loads(output)["outcomes"]
    assert found | {"seconds": 0.0} == expected.to_json() | {"seconds": 0.0}


# ---- plan, the first few grasps; how a start is solved


def test_the_first_grasps(run: Run, gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    pose = (0.8, 0.06, -0.08, 1.2, 0.0, 0.0)
    options = ("--most", 2, "--deadline", 300, "--object-pose", "sphere", *pose)
    code, output, errors = run("plan", "glovebox", "--task", "sphere", *options)
    assert (code, errors) == (0, "")
    found = pinograsp.read_json(tmp_path / "out" / f"{NAMES}.json")
    assert f"{found.verified} of {found.done} starts verified" in output
    with pinograsp.Planner(gen3, glovebox) as planner:
        planner.move("sphere", pinograsp.Pose(position=pose[:3], rpy=pose[3:]))
        grasps = list(planner.grasps("sphere", most=2))
    assert sorted(grasp.start or 0 for grasp in found.grasps) == [grasp.start for grasp in grasps]
    assert pinograsp.verify(found) == ()
    assert (tmp_path / "out" / f"{NAMES}.html").exists()


def test_a_deadline_that_comes_first(run: Run, tmp_path: Path) -> None:
    code, output, errors = run("plan", "glovebox", "--task", "sphere", "--deadline", 0)
    assert code == 1
    assert output.startswith("No verified grasp was found.\n0 of 0 starts verified; solver: no start\n")
    assert re.search(r"^warning: no start was tried: the preparations took [\d.]+ s, the deadline is 0 s\n$", errors)
    assert refused(run("plan", "glovebox", "--task", "sphere", "--deadline", 5, "--seed", 1)) == (
        "error: --seed: is given with --deadline. Give one of them\n"
    )


def test_solver_options(run: Run, tmp_path: Path) -> None:
    plan = ("plan", "glovebox", "--task", "sphere", "--starts", 1, "--workers", 1, "--no-html")
    solver = ("--tries", 2, "--max-evaluations", 40, "--tolerance", 1e-5, "--cost-tolerance", 1e-4)
    run(*plan, *solver, "--projection", "contacts")
    found = pinograsp.read_json(tmp_path / "out" / f"{NAMES}.json")
    options = pinograsp.SolverOptions(
        max_evaluations=40, tries=2, tolerance=1e-5, cost_tolerance=1e-4, projection="contacts"
    )
    assert found.provenance["options"] == options.to_json()
    for option, value, words in (
        ("--tolerance", -1, "must be at least 0"),
        ("--cost-tolerance", "nan", "must be a finite number"),
        ("--projection", "contact", "no projection 'contact'. Did you mean contacts"),
    ):
        assert refused(run(*plan, option, value)).startswith(f"error: {option}: {words}")


# ---- plan, with changes of the scene


def test_plan_with_a_locked_joint_and_a_moved_object(run: Run, gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    pose = (0.8, 0.06, -0.18, 0.0, 0.0, 0.4)
    options = ["--starts", 8, "--workers", 1, "--no-html", "--object-pose", "sphere", *pose, "--lock", "joint_7=0.5"]
    code, output, errors = run("plan", "glovebox", "--task", "sphere", *options)
    assert (code, errors) == (0, "")
    found = pinograsp.read_json(tmp_path / "out" / f"{NAMES}.json")
    assert found.grasps
    for grasp in found.grasps:
        assert grasp.joints["joint_7"] == pytest.approx(0.5, abs=1e-6)
    scene = found.setup.scene
    assert scene.objects["sphere"].pose == pinograsp.Pose(position=pose[:3], rpy=pose[3:])
    assert dict(scene.task("sphere").lock) == {"joint_7": 0.5}
    moved = glovebox.with_object_pose("sphere", pinograsp.Pose(position=pose[:3], rpy=pose[3:]))
    expected = pinograsp.plan(gen3, moved.with_task("sphere", lock={"joint_7": 0.5}), "sphere", starts=8, workers=1)
    assert [grasp.start for grasp in expected.grasps] == [grasp.start for grasp in found.grasps]
    assert math.isclose(expected.grasps[0].cost.U, found.grasps[0].cost.U, rel_tol=1e-9)
    assert f"{found.verified} of 8 starts verified" in output


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--lock", "joint_7"], "--lock: 'joint_7' is not JOINT=VALUE. Give, for example, elbow=0.5"),
        (["--lock", "joint_99=0"], "joint_99"),
        (["--lock", f"{HAND}=9"], HAND),
        (["--object-pose", "cube", 0, 0, 0, 0, 0, 0], "'cube'"),
        (["--object-pose", "sphere", 0, 0, 0, 0, 0, "nan"], "--object-pose YAW: a finite number is wanted"),
        (["--object-pose", "sphere", 0, 1e10, 0, 0, 0, 0], "--object-pose Y: a number between"),
        (["--object-pose", "sphere", 0, 0, 0, 0, 0], "See pinograsp plan --help"),
        (["--object-pose", "sphere", 0, 0, "up", 0, 0, 0], "--object-pose"),
        (["--object-pose", "sphere", 5, 0, 0, 0, 0, 0], "outside the enclosure"),
    ],
    ids=lambda value: " ".join(map(str, value[:3])) if isinstance(value, list) else "",
)
def test_changes_that_cannot_be_made(run: Run, options: list[object], words: str) -> None:
    assert words in refused(run("plan", "glovebox", "--task", "sphere", "--workers", 1, "--starts", 1, *options))


# ---- results that somebody changed


@pytest.mark.parametrize("command", ["show", "rank", "verify", "assess", "hold"])
def test_a_changed_result_is_said_to_be(run: Run, file: Path, command: str, tmp_path: Path) -> None:
    data = json.loads(file.read_text())
    data["grasps"] = data["grasps"][:1]
    data["verified"] = data["grasps"][0]["count"]
    changed = tmp_path / "changed.json"
    changed.write_text(json.dumps(data))
    options = {"assess": ["--samples", 1, "--workers", 1], "hold": ["--workers", 1]}.get(command, [])
    warning = f"warning: {changed}: this result may be wrong: its file was changed since it was written"
    code, output, errors = run(command, changed, "--json", *options)
    assert code != 2
    assert errors.count(warning) == 1
    assert json.loads(output)
    assert warning not in run(command, file, "--json", *options)[2]


def test_python_says_that_a_result_was_changed(file: Path) -> None:
    sound = pinograsp.read_json(file)
    changed = dataclasses.replace(sound, altered=True)
    words = "; its file was changed since it was written"
    assert (words in repr(changed), words in changed._repr_html_()) == (True, True)
    assert (words in repr(sound), words in sound._repr_html_()) == (False, False)
