"""The command line: exit codes, messages, files. Nearly all of it in this process."""

from __future__ import annotations

import dataclasses
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import Run

import pinograsp
from pinograsp.cli.folders import file_name
from pinograsp.database import cache
from pinograsp.descriptions import Scene, schema, shipped_robots, shipped_scenes
from pinograsp.interrupts import held, watched
from pinograsp.planning import task_models
from pinograsp.verification import Certificate, Figure

ROBOT = shipped_robots()["gen3_2f85"].read_text()
SCENE = shipped_scenes()["glovebox"].read_text()
COMMAND = [sys.executable, "-c", "from pinograsp.cli import main; main()"]

needs_proc = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


def refused(outcome: tuple[int, str, str]) -> str:
    """Require exit code 2, one line of error and nothing else; return the line."""
    code, output, errors = outcome
    assert code == 2
    assert output == ""
    assert errors.startswith("error: ")
    assert errors.endswith("\n")
    assert errors.count("\n") == 1
    return errors


# Input that cannot be used.


@pytest.mark.parametrize(
    ("old", "new", "key", "words"),
    [
        ("force_weight", "force_wieght", "tasks.sphere.force_wieght", "Did you mean force_weight?"),
        ("radius: 0.0373", "radius: 0.0.5", "objects.sphere.shape.radius", "a number is wanted"),
        ("[0.801, 0.020, -0.1997]", "[0.801, 0.020, -0.25]", "objects.sphere.pose", "50.3 mm beyond wall z=-0.237"),
        ("[0.801, 0.020, -0.1997]", "[2.0, 0.020, -0.1997]", "objects.sphere.pose", "outside the enclosure"),
        ("[0.0, -0.0373, 0.0]", "[0.0, -0.05, 0.0]", "tasks.sphere.desired_contacts[1]", "12.7 mm outside the surface"),
        ("[0.0, -0.0373, 0.0]", "[0.0, 0.0, 0.0]", "tasks.sphere.desired_contacts[1]", "37.3 mm inside the surface"),
        (
            "[0.0, -0.0373, 0.0]\n",
            "[0.0, -0.0373, 0.0]\n      - [0.0373, 0.0, 0.0]\n",
            "tasks.sphere.desired_contacts",
            "one for each pad",
        ),
    ],
)
def test_bad_scene(run: Run, old: str, new: str, key: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(changed(SCENE, old, new))
    message = refused(run("plan", "scene.yaml", "--task", "sphere", "--starts", 1, "--workers", 1))
    assert f"{file.name}" in message
    assert f": {key}: " in message
    assert words in message


def test_jaw_too_small(run: Run, tmp_path: Path) -> None:
    text = SCENE.replace("0.0373", "0.06").replace("-0.1997", "-0.17")
    (tmp_path / "scene.yaml").write_text(text)
    message = refused(run("plan", "scene.yaml", "--task", "sphere", "--starts", 1, "--workers", 1))
    assert "scene.yaml: objects.sphere.shape: the pads open to 8" in message
    assert "120.0 mm wide" in message


@pytest.mark.parametrize(
    ("old", "new", "key", "words"),
    [
        ("joint_7]", "joint_77]", "arm.joints[6]", "'joint_77' is not in kinova_robotiq.urdf. Did you mean joint_7"),
        ("kinova_robotiq.urdf", "kinova.urdf", "urdf", "kinova.urdf was not found"),
        ("pads:", "padz:", "padz", "Did you mean pads"),
    ],
)
def test_bad_robot(run: Run, old: str, new: str, key: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(changed(ROBOT, old, new))
    message = refused(run("plan", "glovebox", "--task", "sphere", "--robot", "robot.yaml"))
    assert "robot.yaml" in message
    assert f": {key}: " in message
    assert words in message


def test_mesh_that_is_not_found(run: Run, tmp_path: Path, gen3: pinograsp.Robot) -> None:
    urdf = gen3.description.urdf_file.read_text()
    (tmp_path / "arm.urdf").write_text(urdf.replace("collision/left_knuckle.stl", "collision/no_such_mesh.stl"))
    assert "no_such_mesh" in (tmp_path / "arm.urdf").read_text()
    address = next(line for line in ROBOT.splitlines() if line.startswith("urdf:"))
    (tmp_path / "robot.yaml").write_text(changed(ROBOT, address, "urdf: arm.urdf"))
    message = refused(run("plan", "glovebox", "--task", "sphere", "--robot", tmp_path))
    assert "arm.urdf: link " in message
    assert "no_such_mesh" in message
    assert "was not found" in message


def test_files_and_names_that_do_not_exist(run: Run) -> None:
    scene = refused(run("plan", "nowhere/[scene].yaml", "--task", "sphere"))
    assert "nowhere/[scene].yaml: no such scene file" in scene  # and [scene] is no markup
    robot = refused(run("plan", "glovebox", "--task", "sphere", "--robot", "gen3"))
    assert "gen3: no such robot file" in robot
    task = refused(run("plan", "glovebox", "--task", "spere", "--workers", 1))
    assert "glovebox.yaml: tasks: no task 'spere' in this scene. Did you mean sphere?" in task


def test_folder_that_cannot_be_made_is_refused_before_the_work(run: Run, tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    message = refused(run("plan", "glovebox", "--task", "sphere", "--starts", 100_000, "--out", "taken"))
    assert "taken: --out: " in message


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["plan", "glovebox"], "--task"),
        (["plan", "glovebox", "--task", "sphere", "--starts", "0"], "--starts"),
        (["plan", "glovebox", "--task", "sphere", "--starts", "many"], "--starts"),
        (["plan", "glovebox", "--task", "sphere", "--workers", "0"], "--workers"),
        (["plan", "glovebox", "--task", "sphere", "--seed", "-1"], "--seed"),
        (["plan", "glovebox", "--task", "sphere", "--strats", "3"], "--starts"),
        (["schema", "task"], "robot"),
        (["paint"], "paint"),
    ],
    ids=lambda value: " ".join(value[-2:]) if isinstance(value, list) else "",
)
def test_wrong_use_is_one_line(run: Run, arguments: list[str], words: str) -> None:
    code, output, errors = run(*arguments)
    message = refused((code, output, errors))
    command = f" {arguments[0]}" if arguments[0] in ("plan", "schema") else ""
    assert message.endswith(f". See pinograsp{command} --help\n")
    assert words in message


@pytest.mark.parametrize(
    ("option", "name", "words"),
    [
        ("--algorithm", "LN_COBYLLA", "--algorithm: no solver 'LN_COBYLLA'. Did you mean LN_COBYLA?"),
        (
            "--rank-by",
            "clearence",
            "--rank-by: no criterion and no figure is called 'clearence'. Did you mean clear",
        ),
    ],
)
def test_names_that_there_are_not(run: Run, option: str, name: str, words: str) -> None:
    assert words in refused(run("plan", "glovebox", "--task", "sphere", option, name))


# Runs.


def test_good_run(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "a folder" / "of [results]"
    code, output, errors = run("plan", "glovebox", "--task", "sphere", "--starts", 12, "--workers", 1, "--out", folder)
    assert code == 0
    assert errors == ""
    result = pinograsp.read_json(folder / "glovebox_sphere_gen3_2f85.json")
    assert result.done == result.starts == 12
    assert result.best is not None
    assert f" different of {len(result.grasps)} distinct grasps, gen3_2f85 in glovebox" in output
    assert f"{result.verified} of 12 starts verified" in output
    assert f"{result.best.cost.U:.4g}" in output
    page = folder / "glovebox_sphere_gen3_2f85.html"
    assert "<html" in page.read_text()[:1000].lower()
    for file in (folder / "glovebox_sphere_gen3_2f85.json", page):
        assert f"written: {file}\n" in output  # in one piece, however long
    assert output.splitlines()[-1] == f"written: {page}"
    assert sorted(folder.iterdir()) == sorted([folder / "glovebox_sphere_gen3_2f85.json", page])


@pytest.fixture(scope="module")
def planned(gen3: pinograsp.Robot, glovebox: Scene) -> pinograsp.Result:
    """Grasps whose clearances are made up: they rise with the numbers."""
    result = pinograsp.plan(gen3, glovebox, "sphere", starts=3, workers=1)
    grasps = tuple(
        dataclasses.replace(grasp, certificate=Certificate((Figure("self clearance", x, 0.005, "m", "at least"),)))
        for grasp, x in zip(result.grasps, (0.010, 0.011, 0.012), strict=True)
    )
    return dataclasses.replace(result, grasps=grasps)


def test_order_of_table_and_page_is_that_of_one_criterion(
    run: Run, planned: pinograsp.Result, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The file keeps its own."""
    monkeypatch.setattr(pinograsp.Planner, "plan", lambda *_, **__: planned)
    code, output, errors = run("plan", "glovebox", "--task", "sphere", "--rank-by", "clearance")
    assert (code, errors) == (0, "")
    rows = [line.split() for line in output.splitlines() if re.match(r" *\d+ +\d+x ", line)]
    assert [(row[0], row[4]) for row in rows] == [("3", "12.0"), ("2", "11.0"), ("1", "10.0")]
    assert "by clearance" in " ".join(output.split())
    page = (tmp_path / "out" / "glovebox_sphere_gen3_2f85.html").read_text()
    assert "3 distinct grasps by clearance; the first is drawn" in page
    assert re.search(r"<tr><td>3</td><td>1x</td>.*<td>12.0</td>", page)
    written = pinograsp.read_json(tmp_path / "out" / "glovebox_sphere_gen3_2f85.json")
    assert [grasp.start for grasp in written.grasps] == [grasp.start for grasp in planned.grasps]


def test_an_order_by_what_no_grasp_has_says_so(
    run: Run, planned: pinograsp.Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pinograsp.Planner, "plan", lambda *_, **__: planned)
    for name, said in (("Q", True), ("clearance", False), ("score", False)):
        _, _, errors = run("plan", "glovebox", "--task", "sphere", "--rank-by", name, "--no-html")
        assert ("warning: no grasp has Q; the order is that of score" in errors) == said


def test_a_file_that_is_replaced_is_said_to_be(
    run: Run, planned: pinograsp.Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pinograsp.Planner, "plan", lambda *_, **__: planned)
    for done in ("written", "replaced"):
        _, output, _ = run("plan", "glovebox", "--task", "sphere", "--no-html")
        assert output.endswith(f"\n{done}: out/glovebox_sphere_gen3_2f85.json\n")


def test_the_page_of_an_earlier_plan_does_not_stay(
    run: Run, planned: pinograsp.Result, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Neither beside a result without grasps nor beside one whose page is not wanted."""
    page, results = tmp_path / "out" / "glovebox_sphere_gen3_2f85.html", [planned]
    monkeypatch.setattr(pinograsp.Planner, "plan", lambda *_, **__: results[-1])
    plan = ("plan", "glovebox", "--task", "sphere")
    for without in ((dataclasses.replace(planned, grasps=()), ()), (planned, ("--no-html",))):
        results.append(planned)
        run(*plan)
        assert page.exists()
        results.append(without[0])
        _, output, _ = run(*plan, *without[1])
        assert output.endswith("\nremoved: out/glovebox_sphere_gen3_2f85.html, of an earlier plan\n")
        assert not page.exists()


def test_a_name_of_the_longest_can_be_written(planned: pinograsp.Result, tmp_path: Path) -> None:
    """Of scene, task and robot together, with what `hold` and `assess` add, and the folder of an unfinished file."""
    file = tmp_path / file_name(64 * "s", 64 * "t", 64 * "r", "100", "assess", suffix="json")
    pinograsp.write_json(planned, file)
    assert file.exists()


def test_task_without_solution_says_what_blocked_it(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "SIZE", 2000)  # of a database of its own, for margins that no other plan has
    # Fingers 50 mm above the floor cannot hold a sphere whose equator is 37 mm above it.
    (tmp_path / "scene.yaml").write_text(changed(SCENE, "{enclosure: 0.005", "{enclosure: 0.05"))
    code, output, errors = run("plan", "scene.yaml", "--task", "sphere", "--starts", 4, "--workers", 1)
    assert code == 1
    assert errors == ""
    assert "No verified grasp was found." in output
    assert "0 of 4 starts verified" in output
    result = pinograsp.read_json(tmp_path / "out" / "glovebox_sphere_gen3_2f85.json")
    assert result.best is None
    assert sum(blocked.starts for blocked in result.blocked.values()) == 4
    assert "wall" in result.blocked["enclosure clearance"].where
    assert result.blocked["enclosure clearance"].nearest_miss == pytest.approx(0.06, abs=0.055)
    for kind, blocked in result.blocked.items():
        starts = "1 start" if blocked.starts == 1 else f"{blocked.starts} starts"
        assert f"blocked by {kind}: {starts}, nearest miss" in output
    assert "wall z=-0.237" in output
    assert "<h1>Nearest miss</h1>" in (tmp_path / "out" / "glovebox_sphere_gen3_2f85.html").read_text()


def test_no_start_near_the_object(run: Run, tmp_path: Path) -> None:
    text = changed(SCENE, "    object: sphere", "    start_radius: 0.001\n    object: sphere")
    (tmp_path / "scene.yaml").write_text(text)
    code, output, errors = run("plan", "scene.yaml", "--task", "sphere", "--starts", 6, "--workers", 2)
    assert code == 1
    assert "No verified grasp was found." in output
    reason = "no start was found: the database has no configuration that suits the task and has the wrist "
    reason += "within 0.001 m (start_radius) of the object; the nearest has it 0.03 m away: move the object 0.03 m or "
    reason += "more towards the arm, or give a larger start_radius"
    assert errors == f"warning: {reason}\n"
    result = pinograsp.read_json(tmp_path / "out" / "glovebox_sphere_gen3_2f85.json")
    assert (result.warnings, result.done, result.blocked) == ((reason,), 0, {})


def test_a_pose_that_cannot_be_is_found_before_robot_and_pieces_are_made(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def made(*_: object) -> None:
        pytest.fail("pieces are made")

    monkeypatch.setattr(task_models, "link_bodies", made)
    options = ("--object-pose", "sphere", 0.8, 0.02, -0.5, 0, 0, 0)
    message = refused(run("plan", "glovebox", "--task", "sphere", "--workers", 1, *options))
    assert (
        "error: --object-pose: the object 'sphere' is outside the enclosure: 300.3 mm beyond wall z=-0.237" in message
    )


def test_a_fault_of_the_program_has_an_exit_code_of_its_own(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not that of a plan without grasps."""

    def broken(name: str) -> Scene:
        raise ZeroDivisionError(name)

    monkeypatch.setattr(pinograsp, "load_scene", broken)
    code, output, errors = run("plan", "glovebox", "--task", "sphere")
    assert (code, output) == (70, "")
    first, *lines = errors.splitlines()
    assert first == "error: a fault of pinograsp itself; please report it with these lines:"
    assert (lines[0], lines[-1]) == ("Traceback (most recent call last):", "ZeroDivisionError: glovebox")
    assert "; 70 a fault of pinograsp itself;" in " ".join(run("--help")[1].split())


def test_list_and_schema(run: Run) -> None:
    code, output, _ = run("list")
    assert code == 0
    assert "robot gen3_2f85: Kinova Gen3" in output
    assert "scene glovebox: " in output
    assert "tasks: sphere" in output
    for kind in ("robot", "scene"):
        for options in ((), ("--json",)):
            code, output, _ = run("schema", kind, *options)
            assert code == 0
            assert json.loads(output) == schema(kind)  # type: ignore[arg-type]


# Real processes.


def test_error_from_a_real_process(tmp_path: Path) -> None:
    done = subprocess.run(
        [*COMMAND, "plan", "nope.yaml", "--task", "sphere"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("error: nope.yaml: no such scene file")
    assert done.stderr.count("\n") == 1


def group_members(group: int) -> list[int]:
    """Process numbers of the living members of a process group."""
    members = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            state, _, process_group = (entry / "stat").read_text().rpartition(")")[2].split()[:3]
        except OSError:  # ended meanwhile
            continue
        if int(process_group) == group and state != "Z":
            members.append(int(entry.name))
    return members


CTRL_C_STARTS = 1000
COMMAND_WITH_A_SIGN = """
import sys
from pathlib import Path
from pinograsp import cli
from pinograsp.cli.folders import file_name
from pinograsp.cli.reporters import Lines

STAGE = sys.argv.pop(1)

def sign(lines, progress, real=Lines.__call__):
    real(lines, progress)
    if progress.stage == STAGE and progress.done:
        Path("begun").touch()

Lines.__call__ = sign
cli.main()
"""


def interrupted(folder: Path, stage: str, *arguments: object, number: int = signal.SIGINT) -> tuple[int, str]:
    """Run a command of two processes in a folder until a stage goes on, send a signal, and return code and output."""
    with (folder / "output").open("w") as output:
        process = subprocess.Popen(
            [sys.executable, "-c", COMMAND_WITH_A_SIGN, stage, *map(str, arguments), "--workers", "2"],
            cwd=folder,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    try:
        deadline = time.monotonic() + 120
        while not (folder / "begun").exists() and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.02)
        assert len(group_members(process.pid)) == 3
        os.killpg(process.pid, number)  # as a terminal does
        code = process.wait(120)
        assert group_members(process.pid) == []
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    said = (folder / "output").read_text()
    assert "Traceback" not in said
    return code, said


@needs_proc
def test_ctrl_c_while_grading_keeps_every_grasp(tmp_path: Path) -> None:
    code, said = interrupted(
        tmp_path, "resistance", "plan", "glovebox", "--task", "sphere", "--starts", 400, "--no-html"
    )
    assert code == 130, said
    (written,) = (tmp_path / "out").iterdir()
    result = pinograsp.read_json(written)
    assert result.interrupted
    assert result.done == 400
    assert sum(grasp.count for grasp in result.grasps) == result.verified > 200
    graded = sum("Q_force" in grasp.certificate for grasp in result.grasps)
    assert 0 < graded < len(result.grasps)
    assert "interrupted: the resistance of some grasps is not known" in said


@needs_proc
def test_ctrl_c_is_one_line_where_there_is_nothing_to_keep(tmp_path: Path) -> None:
    code, said = interrupted(
        tmp_path, "start database", "database", "build", "box.duckdb", "--scene", "glovebox", "--size", "1e6"
    )
    assert code == 130, said
    assert said.splitlines()[-1] == "error: interrupted; the same command goes on where box.duckdb ends"


@needs_proc
def test_sigterm_keeps_what_is_done(tmp_path: Path) -> None:
    arguments = ["plan", "glovebox", "--task", "sphere", "--starts", CTRL_C_STARTS, "--no-html"]
    code, said = interrupted(tmp_path, "starts", *arguments, number=signal.SIGTERM)
    assert code == 143, said
    (written,) = (tmp_path / "out").iterdir()
    result = pinograsp.read_json(written)
    assert result.interrupted
    assert result.best is not None
    assert 0 < result.done < CTRL_C_STARTS
    assert f"{CTRL_C_STARTS - result.done} of {CTRL_C_STARTS} starts not tried: interrupted" in said


CTRL_C_WITHIN_AN_IMPORT = """
import os, signal, sys
from pinograsp import cli
from pinograsp.cli.folders import file_name

class Presser:
    module = sys.argv.pop(1)

    def find_spec(self, name, path=None, target=None):
        if name == self.module:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Presser())
cli.main()
"""


@pytest.mark.parametrize("module", ["numpy", "pinocchio.utils", "scipy.sparse.csgraph", "scipy.sparse.csgraph._tools"])
def test_ctrl_c_within_an_import_is_not_lost(module: str, tmp_path: Path) -> None:
    """Compiled modules drop what a module raises that they import: SciPy's k-d tree that of `csgraph`."""
    command = ("plan", "glovebox", "--task", "sphere", "--starts", "1", "--workers", "1")
    done = subprocess.run(
        [sys.executable, "-c", CTRL_C_WITHIN_AN_IMPORT, module, *command],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 130, done.stderr
    assert done.stderr == "error: interrupted\n"
    assert list((tmp_path / "out").glob("*")) == []


def test_ctrl_c_within_what_llvm_calls_comes_after_it() -> None:
    """C drops what Python raises there."""
    file = str(Path("site-packages", "llvmlite", "binding", "executionengine.py"))
    called = compile("os.kill(os.getpid(), signal.SIGINT); done.append('called')", file, "exec")
    done: list[str] = []
    with pytest.raises(KeyboardInterrupt), watched():
        exec(called, {"os": os, "signal": signal, "done": done})
        time.sleep(10.0)
        done.append("slept")
    assert done == ["called"]


def test_ctrl_c_while_files_are_written_comes_after_them() -> None:
    written = []
    with pytest.raises(KeyboardInterrupt), held():
        os.kill(os.getpid(), signal.SIGINT)
        written.append("file")
    assert written == ["file"]
