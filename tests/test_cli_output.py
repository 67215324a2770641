"""The command line: what is loaded, what is written where, and how it looks."""

from __future__ import annotations

import errno
import gc
import inspect
import json
import math
import os
import pty
import shlex
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import typer
from conftest import HEAVY, Run

import pinograsp
from pinograsp import Certificate, Contact, Figure, PairClearance, Progress, Result, cli
from pinograsp.cli import completion, reporters
from pinograsp.cli.folders import file_name, save
from pinograsp.cli.orders import ORDERS
from pinograsp.cli.spelling import spelled
from pinograsp.cli.terminal import Terminal
from pinograsp.onboarding.check import RobotReport
from pinograsp.onboarding.findings import Finding, LinkFigures
from pinograsp.onboarding.table import findings_table, links_table
from pinograsp.results.encoding import encode
from pinograsp.results.table import clearances_table, contacts_table, figures_table, grasp_table, list_table

COMMAND = [sys.executable, "-W", "error", "-m", "pinograsp"]
LONG = "robotiq_85_right_inner_knuckle_link"
"""As long as names of links are."""


@pytest.fixture(scope="module")
def result(gen3: pinograsp.Robot, glovebox: pinograsp.Scene) -> Result:
    return pinograsp.plan(gen3, glovebox, "sphere", starts=6, workers=1)


@pytest.fixture(scope="module")
def file(result: Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    written = tmp_path_factory.mktemp("results") / "result.json"
    pinograsp.write_json(result, written)
    return written


def commands(app: object = None, before: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Yield the words of every command."""
    known = typer.main.get_command(cli.app) if app is None else app
    for name, command in known.commands.items():  # type: ignore[attr-defined]
        if hasattr(command, "commands"):
            yield from commands(command, (*before, name))
        else:
            yield (*before, name)


EVERY = list(commands())


# ---- what is loaded


def loaded(*arguments: object, folder: Path) -> tuple[int, list[str]]:
    """Return the exit code of a command in a process of its own, and the heavy libraries that it loads."""
    script = (
        "import atexit, pathlib, sys\n"
        "loaded = pathlib.Path('loaded')\n"
        f"atexit.register(lambda: loaded.write_text(' '.join(n for n in {HEAVY} if n in sys.modules)))\n"
        "from pinograsp.cli import main\n"
        "main()\n"
    )
    command = [sys.executable, "-W", "error", "-c", script, *map(str, arguments)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=120)
    assert "Traceback" not in done.stderr
    return done.returncode, (folder / "loaded").read_text().split()


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--help"], 0),
        (["--version"], 0),
        *(([*words, "--help"], 0) for words in (["plan"], ["robot"], ["robot", "new"], ["database", "build"])),
        (["plan", "nosuch.yaml", "--task", "x"], 2),
        (["plan", "wrong.yaml", "--task", "sphere"], 2),
        (["plan", "glovebox", "--task", "spere"], 2),
        (["plan", "glovebox", "--task", "sphere", "--robot", "wrong.yaml"], 2),
        (["plan", "glovebox", "--task", "sphere", "--starts", "many"], 2),
        (["check", "glovebox", "--task", "sphere", "--joints", "nosuch.json"], 2),
        (["list"], 0),
        (["schema", "scene"], 0),
    ],
    ids=lambda value: " ".join(value[-2:]) if isinstance(value, list) else "",
)
def test_help_and_errors_load_nothing_heavy(arguments: list[str], code: int, tmp_path: Path) -> None:
    (tmp_path / "wrong.yaml").write_text("format: 1\nname: wrong\n")
    assert loaded(*arguments, folder=tmp_path) == (code, [])


def test_reading_a_result_loads_nothing_heavy(file: Path, tmp_path: Path) -> None:
    assert loaded("rank", file, "--pareto", "U,clearance", folder=tmp_path) == (0, [])
    assert loaded("rank", file, "--json", folder=tmp_path) == (0, [])
    assert loaded("show", file, folder=tmp_path) == (0, [])


# ---- help


def help_of(run: Run, monkeypatch: pytest.MonkeyPatch, width: int, *words: str) -> str:
    monkeypatch.setenv("COLUMNS", str(width))
    code, output, errors = run(*words, "--help")
    assert (code, errors) == (0, "")
    return output


def test_top_of_the_help(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every command has a line that is not cut."""
    text = help_of(run, monkeypatch, 80)
    assert "..." not in text.partition("Commands:")[2]
    for name in {words[0] for words in EVERY}:
        assert f"\n  {name} " in text
    for option in ("--version", "--install-completion", "--show-completion"):
        assert option in text


@pytest.mark.parametrize("words", EVERY, ids=" ".join)
def test_help_of_commands(words: tuple[str, ...], run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each has --json, --quiet and an example of its own that is understood, and fits the terminal."""
    text = help_of(run, monkeypatch, 80, *words)
    assert max(map(len, text.splitlines())) <= 80
    assert "\n  --json " in text
    assert "\n  -q, --quiet " in text
    examples = text.partition("Examples:\n")[2].replace("\\\n", " ").splitlines()
    assert examples
    for example in examples:
        name, *arguments = shlex.split(example.partition(" > ")[0])
        assert name == "pinograsp"
        assert tuple(arguments[: len(words)]) == words
        command = typer.main.get_command(cli.app)
        for word in words:
            command = command.commands[word]  # type: ignore[attr-defined]
        command.make_context(" ".join(words), arguments[len(words) :])


def test_narrow_help(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    assert max(map(len, help_of(run, monkeypatch, 60, "rank").partition("Examples:")[0].splitlines())) <= 60


def test_orders_in_the_help_are_all_that_there_are(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    for command in ("plan", "rank"):
        text = help_of(run, monkeypatch, 200, command)
        for criterion in pinograsp.CRITERIA:
            assert criterion.name in text
    assert ", ".join(["score", *(criterion.name for criterion in pinograsp.CRITERIA)]) == ORDERS


def help_defaults(*words: str) -> dict[str, str]:
    """Return the defaults that the help of a command shows, by the names of its parameters."""
    command = typer.main.get_command(cli.app)
    for word in words:
        command = command.commands[word]  # type: ignore[attr-defined]
    shown = {p.name: getattr(p, "show_default", True) for p in command.params}
    return {p.name: str(p.default if shown[p.name] is True else shown[p.name]) for p in command.params}


def test_defaults_in_the_help_are_those_of_the_library() -> None:
    """Those of `assess` have a test beside the assessment's."""

    def default(function: Callable[..., object], name: str) -> str:
        return str(inspect.signature(function).parameters[name].default)

    plan, hold = help_defaults("plan"), help_defaults("hold")
    assert (plan["starts"], plan["seed"]) == (default(pinograsp.plan, "starts"), default(pinograsp.plan, "seed"))
    options = pinograsp.SolverOptions()
    assert (plan["algorithm"], plan["rank_by"]) == (options.algorithm, default(Result.ranked, "by"))
    assert hold["best"] == default(pinograsp.hold_test, "best")
    held = pinograsp.HoldOptions()
    assert (hold["acceleration"], hold["spin"]) == (str(held.acceleration), str(held.spin))
    build, margins = help_defaults("database", "build"), pinograsp.Margins()
    assert (float(build["margin"]), margins.robot) == (margins.enclosure, margins.enclosure)
    assert (build["seed"], build["spread"]) == tuple(default(pinograsp.build_database, n) for n in ("seed", "spread"))
    assert help_defaults("database", "coverage")["voxel"] == default(pinograsp.Coverage.of, "voxel")
    rank = help_defaults("rank")
    assert (rank["by"], rank["different"]) == tuple(default(Result.different, n) for n in ("by", "most"))


def test_without_a_command_the_help_is_an_error(run: Run) -> None:
    for words in ((), ("robot",), ("database",)):
        code, output, errors = run(*words)
        assert (code, output) == (2, "")
        assert errors.startswith(f"Usage: pinograsp {' '.join([*words, '[OPTIONS]'])}")


def test_version(run: Run) -> None:
    assert run("--version") == (0, f"pinograsp {pinograsp.__version__}\n", "")


# ---- JSON and quiet


def test_plan_as_json(run: Run, result: Result, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Standard output is the document of the file, messages are on standard error."""
    monkeypatch.setattr(pinograsp.Planner, "plan", lambda *_, **__: result)
    code, output, errors = run("plan", "glovebox", "--task", "sphere", "--json", "--no-html")
    written = tmp_path / "out" / "glovebox_sphere_gen3_2f85.json"
    assert code == 0
    assert json.loads(output) == json.loads(written.read_text()) == encode(result)
    assert errors == "written: out/glovebox_sphere_gen3_2f85.json\n"


def test_quiet(run: Run, result: Result, file: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(pinograsp.Planner, "plan", lambda *_, **__: replace(result, warnings=("odd",)))
    assert run("plan", "glovebox", "--task", "sphere", "--quiet", "--no-html") == (0, "", "")
    assert (tmp_path / "out" / "glovebox_sphere_gen3_2f85.json").exists()
    assert run("rank", file, "-q") == (0, "", "")
    assert run("list", "-q") == (0, "", "")
    code, output, errors = run("rank", "nosuch.json", "-q")
    assert (code, output, errors.count("\n")) == (2, "", 1)
    code, output, errors = run("list", "-q", "--json")
    assert (code, errors) == (0, "")
    assert {robot["name"] for robot in json.loads(output)["robots"]} == set(pinograsp.shipped_robots())


def test_warnings_are_on_standard_error(run: Run, result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pinograsp.Planner, "plan", lambda *_, **__: replace(result, warnings=("the ball is odd",)))
    _, output, errors = run("plan", "glovebox", "--task", "sphere", "--no-html")
    assert "odd" not in output
    assert errors == "warning: the ball is odd\n"


def test_files_are_written_before_the_terminal_is(
    run: Run, result: Result, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """So that a terminal that is full or gone loses nothing."""
    monkeypatch.setattr(pinograsp.Planner, "plan", lambda *_, **__: result)

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(typer, "echo", full)
    assert run("plan", "glovebox", "--task", "sphere", "--no-html")[0] == 2
    assert (tmp_path / "out" / "glovebox_sphere_gen3_2f85.json").exists()


def test_what_is_said_of_files(tmp_path: Path) -> None:
    assert file_name("scene", "task", "robot", "grasp3", suffix="html") == "scene_task_robot_grasp3.html"
    file = tmp_path / "file"
    assert save(file, lambda: file.write_text("new")) == f"written: {file}"
    assert save(file, lambda: file.write_text("newer")) == f"replaced: {file}"


def test_a_paragraph_wraps_in_a_terminal_alone(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "30")
    text = f"scene glovebox: the {LONG} room of the paper, with a sphere"
    Terminal(as_json=False, quiet=False).paragraph(text)
    assert capsys.readouterr().out == f"{text}\n"
    monkeypatch.setattr("pinograsp.cli.terminal._is_terminal", lambda stream: True)
    Terminal(as_json=False, quiet=False).paragraph(text)
    lines = capsys.readouterr().out.splitlines()
    assert " ".join(line.strip() for line in lines) == text
    assert all(len(line) <= 30 or line.strip() == LONG for line in lines)
    assert all(line.startswith("  ") for line in lines[1:])


# ---- progress


def test_lines_of_progress(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """One every two seconds, and then also where a stage begins; none for what is quick."""
    now = [100.0]
    monkeypatch.setattr(reporters, "INTERVAL", 2.0)
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    lines = reporters.Lines()
    for seconds, progress in (
        (0.5, Progress("compiling", 3)),
        (1.9, Progress("starts", 1, 1304)),
        (2.1, Progress("starts", 700, 1304, {"verified": 699, "best U": 2.17871})),
        (4.0, Progress("starts", 1304, 1304, {"verified": 1300, "best U": 2.17871})),
        (4.05, Progress("resistance", 1, 1300)),
        (4.1, Progress("resistance", 2, 1300)),
    ):
        now[0] = 100.0 + seconds
        lines(progress)
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err == "starts: 700 of 1,304, verified 699, best U 2.179\nresistance: 1 of 1,300\n"


@pytest.mark.parametrize("number", [errno.EPIPE, errno.EIO, errno.ENOSPC])
def test_progress_that_cannot_be_written_ends_no_plan(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(reporters, "INTERVAL", 0.0)
    monkeypatch.setattr(typer, "echo", fail)
    reporters.Lines()(Progress("starts", 1, 4))
    monkeypatch.setattr(sys.stderr, "write", fail)
    with reporters.reporter(quiet=False, terminal=True) as report:
        report(Progress("starts", 1, 4))


def test_a_number_without_a_total_is_what_is_done_so_far() -> None:
    assert str(Progress("compiling", 121)) == "compiling: 121 so far"


def test_a_bar_in_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with reporters.reporter(quiet=False, terminal=True) as report:
        report(Progress("starts", 1, 4))
        report(Progress("resistance", 2, None))
    errors = capsys.readouterr().err
    for words in ("preparing", "starts: 1 of 4", "resistance: 2"):
        assert words in errors


def test_no_progress_if_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    with reporters.reporter(quiet=True, terminal=True) as report:
        report(Progress("starts", 1, 4))
    assert capsys.readouterr() == ("", "")


def test_no_thread_shows_progress() -> None:
    """Processes that are forked meanwhile would inherit its locks."""
    import threading

    before = threading.active_count()
    with reporters.reporter(quiet=False, terminal=True) as report:
        report(Progress("starts", 1, 4))
        assert threading.active_count() == before


def test_garbage_is_looked_for_seldom_but_it_is(run: Run, result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    """The process that calls the command line goes on as before."""
    seen: list[tuple[bool, int]] = []
    before = gc.get_threshold()
    monkeypatch.setattr(
        pinograsp, "read_json", lambda _: seen.append((gc.isenabled(), gc.get_threshold()[0])) or result
    )
    assert run("rank", "result.json")[0] == 0
    assert (seen, gc.get_threshold()) == ([(True, 100_000)], before)


# ---- tables


def wide(result: Result, joints: int) -> Result:
    """Return a result whose numbers are as wide as they get."""
    figures = (
        Figure("Q_force", 123.456, -math.inf, "m/s^2", "at least"),
        Figure("self clearance", 0.05, 0.005, "m", "at least"),
        Figure("joint reserve", math.radians(123.4), 0.02, "rad", "at least"),
    )
    grasps = []
    for index in range(1200):
        T = np.array(result.grasps[0].T_world_wrist)
        T[0, 3] = 0.1 * (index // 100)
        changed = replace(
            result.grasps[0],
            count=1304 if index % 100 == 0 else 0,
            q_arm=np.full(joints, -math.pi),
            cost=replace(result.grasps[0].cost, U=1234.5 + index / 1e4),
            certificate=Certificate(figures),
            T_world_wrist=T,
        )
        grasps.append(changed)
    return replace(result, grasps=tuple(grasps))


@pytest.mark.parametrize("width", [80, 60])
@pytest.mark.parametrize("joints", [6, 7, 9])
def test_grasps_fit(result: Result, joints: int, width: int) -> None:
    found = wide(result, joints)
    text = grasp_table(found, width=width).drawn(width)
    assert max(map(len, text.splitlines())) <= width
    assert text.count(" -180") == 10 * joints
    assert text.count(" 123.46   50.0    123.4 ") == 10
    listed = [(grasp, 1304) for grasp in found.grasps[::300]]
    text = list_table(found, listed, "title", ["joint reserve"], width).drawn(width)
    assert text.count(" -180") == 4 * joints
    assert text.count(" 123 ") == 4
    assert max(map(len, text.splitlines())) <= max(width, 68)  # a column more, where numbers alone fill the line


@pytest.mark.parametrize("width", [80, 60])
def test_figures_clearances_and_contacts_fit(width: int) -> None:
    names = ("pad clearance", "force balance", "torque balance", "manipulability")
    figures = [Figure(name, -1.2345e-15, 1.5e-4, "N m", "at most", f"{LONG} / {LONG}") for name in names]
    text = figures_table(figures).drawn(width)
    assert max(map(len, text.splitlines())) <= width
    assert "manipulability" in text
    assert text.count("-1.23e-12 N mm") == text.count("≤ 0.15 N mm") == 4
    pairs = [PairClearance("enclosure clearance", LONG, LONG, distance) for distance in (-0.0123, 0.05, -math.inf)]
    text = clearances_table(pairs).drawn(width)
    assert max(map(len, text.splitlines())) <= width
    assert [line.split()[0] for line in text.splitlines() if "/" in line] == ["-12.3", "50.0", "overlap"]
    assert text.count(LONG) == 6
    vectors = {name: np.full(3, -123.456) for name in ("normal", "force", "desired_point")}
    contact = Contact(
        pad="ring finger", link=LONG, point=np.full(3, -1.2345), spin_torque=-0.123, T_world_pad=np.eye(4), **vectors
    )
    text = contacts_table([contact]).drawn(width)
    assert max(map(len, text.splitlines())) <= max(width, 76)
    assert (text.count("-1234.5"), text.count("-123.46"), text.count("-123.0")) == (3, 3, 1)


@pytest.mark.parametrize("width", [80, 60])
def test_a_check_of_a_robot_fits(width: int) -> None:
    findings = (Finding("wrong", f"{LONG} and {LONG} are nearer than 5 mm in every posture", "Excuse the pair"),)
    links = (LinkFigures(LONG, 123_456, True, 12, 0.0123, 0.1234),)
    report = RobotReport("robot", findings, links)
    for table in (findings_table(report), links_table(report)):
        assert max(map(len, table.drawn(width).splitlines())) <= width
    row = next(line for line in links_table(report).drawn(width).splitlines() if "123456" in line)
    assert row.split()[1:] == ["123456", "yes", "12", "12.3", "123.4"]


def test_a_narrow_terminal_cuts_no_number(result: Result) -> None:
    text = grasp_table(wide(result, 7), width=20).drawn(20)
    assert text.count(" -180") == 70
    assert text.count("123.46") == 10
    assert "…" not in text


def test_only_terminals_get_color() -> None:
    failing = [Figure("friction", 1.0, 0.0, "N", "at most")]
    assert "\x1b[" not in figures_table(failing).drawn(80)
    assert "\x1b[31m" in figures_table(failing).drawn(80, color=True)


# ---- encodings, pipes, closed terminals


def test_spelling_of_what_an_encoding_lacks() -> None:
    import codecs

    codecs.register_error("spelled for the test", spelled)
    text = "5 m/s², 3 m³, 7°, ≥ 2, é, \udce9"
    assert text.encode("ascii", "spelled for the test") == b"5 m/s^2, 3 m^3, 7deg, >= 2, \\xe9, \xe9"


def test_a_terminal_of_ascii(file: Path) -> None:
    environment = os.environ | {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0", "LC_ALL": "C"}
    done = subprocess.run([*COMMAND, "rank", file], capture_output=True, env=environment, check=False, timeout=120)
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"m/s^2" in done.stdout
    assert b"-----" in done.stdout


def test_a_reader_that_has_seen_enough(file: Path) -> None:
    """As of `pinograsp show FILE | head -1`: no traceback, and the exit code of the command."""
    for arguments in (["show", str(file)], ["schema", "scene"], ["plan", "--help"]):
        command = [*COMMAND, *arguments]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            assert process.stdout is not None
            assert process.stderr is not None
            process.stdout.close()
            assert process.stderr.read() == b""
        assert process.returncode in ((0,) if arguments[0] != "plan" else (0, 1))


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="writes to /dev/full")
def test_a_full_disk_is_one_line() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([*COMMAND, "list"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "error: standard output: cannot be written: no space left on device\n"


def test_streams_that_are_closed(file: Path) -> None:
    done = subprocess.run(["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh", *COMMAND, "rank", str(file)], check=False)
    assert done.returncode == 0


def test_warnings_of_the_library_are_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with warnings.catch_warnings():
        Terminal(as_json=False, quiet=False)
        warnings.warn("the cache is full", pinograsp.CacheWarning, stacklevel=1)
        assert capsys.readouterr() == ("", "warning: the cache is full\n")
        Terminal(as_json=False, quiet=True)
        warnings.warn("the cache is full", pinograsp.CacheWarning, stacklevel=1)
        assert capsys.readouterr() == ("", "")


def test_colors_and_bar_are_for_terminals(file: Path, tmp_path: Path) -> None:
    """In a terminal of 60 columns nothing is wider."""
    parent, child = pty.openpty()
    import fcntl
    import struct
    import termios

    fcntl.ioctl(child, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 60, 0, 0))
    environment = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "NO_COLOR")}
    command = [*COMMAND, "verify", str(file)]
    with (tmp_path / "output").open("w") as output:
        process = subprocess.Popen(command, stdout=output, stderr=child, env=environment | {"TERM": "xterm"})
        os.close(child)
        shown = b""
        try:
            while part := os.read(parent, 4096):
                shown += part
        except OSError:  # the other end is closed
            pass
        assert process.wait(120) == 0, shown
    os.close(parent)
    assert b"certificates: 1 of 6" in shown
    assert (tmp_path / "output").read_text() == "6 grasps recomputed: every certificate stands\n"


# ---- completion


def completed(*words: str, folder: Path) -> list[str]:
    """Return what bash is told to complete the last word with."""
    environment = os.environ | {
        "_PINOGRASP_COMPLETE": "complete_bash",
        "COMP_WORDS": " ".join(["pinograsp", *words]),
        "COMP_CWORD": str(len(words)),
    }
    done = subprocess.run(COMMAND, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    return done.stdout.split()


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["ver"], ["verify"]),
        (["plan", "glovebox_can_"], ["glovebox_can_near_wall"]),
        (["plan", "mine"], ["mine.yaml"]),
        (["plan", "sub/"], ["sub/other.yaml"]),
        (["plan", "glovebox_can", "--task", "can_region_"], ["can_region_point"]),
        (["plan", "nosuch.yaml", "--task", "c"], []),
        (["plan", "glovebox", "--robot", "panda"], ["panda"]),
        (["rank", "result.json", "--by", "Q_"], ["Q_force", "Q_torque"]),
        (["database", "c"], ["coverage"]),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_completion(words: list[str], found: list[str], tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("")
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "other.yaml").write_text("")
    assert sorted(completed(*words, folder=tmp_path)) == found


def test_completion_never_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> dict[str, Path]:
        raise RuntimeError

    monkeypatch.setattr(pinograsp, "shipped_robots", broken)
    assert completion.robots("") == []
    assert completion.robots("/no/such/folder/") == []
