"""The page that sets the paper's cases beside ours: tables, figures, what is kept and loaded again."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import pinograsp
import reproduce_paper
from paper import algorithms, alternative, comparison, figures, hand_poses, inverse_kinematics, runs, sweep, tables
from paper.attempts import Attempt, attempts_table
from paper.cases import CASES, Case
from paper.figures import photograph
from paper.page import Heading, Pictures, Table, Text, write_page
from paper.runs import Session
from paper.store import Store, key_of
from pinograsp.descriptions import Scene
from pinograsp.problem import GraspProblem, TaskModel
from pinograsp.solve.backends import Program


@pytest.fixture(scope="module", autouse=True)
def quick(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Small start databases of this module's own; grasps are not photographed, which takes a browser and seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PINOGRASP_CACHE", str(tmp_path_factory.mktemp("cache")))
        patch.setattr("pinograsp.database.cache.SIZE", 1000)
        for module in ("sampling", "build"):
            patch.setattr(f"pinograsp.database.{module}.DRAWS", 16_384)
        patch.setattr(figures, "photograph", lambda *_: "no picture was wanted")
        yield


@pytest.fixture(scope="module", autouse=True)
def ball(toy_task: TaskModel) -> Iterator[Case]:
    """The toy and its ball stand for the paper's sphere: they take no time."""
    with pytest.MonkeyPatch.context() as patch:
        case = dataclasses.replace(CASES["sphere"], scene=str(toy_task.scene.source), task="ball")
        patch.setitem(CASES, "sphere", case)
        yield case


@pytest.fixture(scope="module")
def small(toy: pinograsp.Robot) -> list[str]:
    """Options of a small run."""
    return ["--robots", str(toy.description.source), "--cases", "sphere", "--starts", "4", "--workers", "1"]


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory, small: list[str]) -> Path:
    """The folder of one small run."""
    folder = tmp_path_factory.mktemp("paper")
    assert reproduce_paper.main([str(folder), *small]) == 0
    return folder


@pytest.fixture
def no_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    def plan(*_: object, **__: object) -> None:
        raise AssertionError("planned again")

    monkeypatch.setattr(pinograsp, "plan", plan)


class Tags(HTMLParser):
    """Checks that tags are closed in order, and collects pictures."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.sources: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "img":
            self.sources.append(dict(attrs)["src"] or "")
        elif tag not in {"meta", "br"}:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_page_renders(out: Path) -> None:
    markdown = (out / "paper.md").read_text()
    for heading in ("Summary", "Marks to reach", "Sorted costs", "Tables 4 and 5", "Best grasps", "Printed and used"):
        assert f"## {heading}" in markdown
    assert "no picture was wanted" in markdown
    assert (out / "pictures" / "costs-sphere.png").is_file()
    assert "](pictures/costs-sphere.png)" in markdown
    tags = Tags()
    tags.feed((out / "paper.html").read_text())
    assert not tags.open
    assert tags.sources
    assert all(source.startswith("data:image/png;base64,") for source in tags.sources)


@pytest.mark.usefixtures("no_plan")
def test_results_are_loaded_again(out: Path, small: list[str]) -> None:
    before = (out / "results" / "toy-sphere.json").read_bytes()
    assert reproduce_paper.main([str(out), *small]) == 0
    assert (out / "results" / "toy-sphere.json").read_bytes() == before


@pytest.mark.usefixtures("no_plan")
@pytest.mark.parametrize("more", [("--starts", "5"), ("--seed", "1"), ("--fresh",)])
def test_other_options_are_planned_again(out: Path, small: list[str], more: tuple[str, ...]) -> None:
    with pytest.raises(AssertionError, match="planned again"):
        reproduce_paper.main([str(out), *small, *more])


@pytest.mark.usefixtures("no_plan")
def test_another_robot_file_is_planned_again(out: Path, small: list[str], toy: pinograsp.Robot) -> None:
    source = toy.description.source
    changed = source.with_name("changed.yaml")
    changed.write_text(source.read_text() + "# another digest\n")
    with pytest.raises(AssertionError, match="planned again"):
        reproduce_paper.main([str(out), *small, "--robots", str(changed)])


def test_interrupted_plan_is_not_kept(
    tmp_path: Path,
    small: list[str],
    result: pinograsp.Result,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(pinograsp, "plan", lambda *_, **__: dataclasses.replace(result, interrupted=True))
    assert reproduce_paper.main([str(tmp_path), *small]) == 130
    assert "goes on" in capsys.readouterr().err
    assert not list(tmp_path.glob("results/*"))


def test_unknown_robot_is_refused_before_the_work(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert reproduce_paper.main([str(tmp_path), "--robots", "gen3_2f58"]) == 2
    assert "gen3_2f58" in capsys.readouterr().err


@pytest.fixture
def result(out: Path) -> pinograsp.Result:
    return pinograsp.read_json(out / "results" / "toy-sphere.json")


@pytest.fixture
def session(toy: pinograsp.Robot, tmp_path: Path) -> Session:
    return Session(Store(tmp_path), (toy,), tuple(CASES.values()), starts=4, seed=0, workers=1)


@pytest.fixture
def ball_session(session: Session, ball: Case) -> Session:
    return dataclasses.replace(session, cases=(ball,))


@pytest.mark.paper
def test_tables_have_the_printed_rows(session: Session, result: pinograsp.Result) -> None:
    """Rows as Tables 4 and 5 and section 5 print them."""
    results = {("toy", name): result for name in CASES}
    summary, table_4, table_5 = (
        block
        for section in (tables.summary_section, tables.printed_tables_section)
        for block in section(session, results)
        if isinstance(block, Table)
    )
    assert ("sphere", "paper", "1304", "722 (55.4 %)", "", "2.178", "3.5e-05", "2.178", "10-12 h", "") in summary.rows
    shares = ["722 (55.4 %)", "479 (36.7 %)", "101 (7.7 %)", "507 (38.9 %)"]
    assert [row[3] for row in summary.rows[::2]] == [*shares, shares[-1]]  # case 3 by points and by footprints
    assert table_4.rows[2] == (
        *("Sim. 2", "paper", "[1.671, -0.785, -0.471, 1.937, 6.155, -1.168, 1.857]"),
        *("2.116", "[-3.236, -1.938]", "-5.111"),
    )
    assert table_5.rows[4] == (
        *("Sim. 3", "paper", "[2.116, -0.545, -0.362, 0.545]", "[2.104, -0.533, 1.036, 0.533]"),
        *("[-1.062, -0.872, 3.527]", "[-0.937, 0.872, -3.527]"),
    )
    assert [row[1] for row in table_5.rows] == 5 * ["paper", "toy"]


@pytest.mark.paper
def test_forces_stand_in_the_papers_frame(result: pinograsp.Result, glovebox: Scene) -> None:
    """Sim. 1 of Table 5: pads at +y and -y that carry 1 N of weight each, up to the rounding of three digits."""
    assert result.best is not None
    side, upwards = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
    contacts = tuple(
        dataclasses.replace(contact, desired_point=sign * side, force=upwards - 3.631 * sign * side)
        for contact, sign in zip(result.best.contacts, (-1.0, 1.0), strict=True)
    )
    base = np.array(glovebox.mounting.matrix)[:3, :3]
    grasp = dataclasses.replace(result.best, contacts=contacts)
    q, q_r, f_1, f_2 = (list(values) for values in tables.table_5_row(grasp, base))
    np.testing.assert_allclose(f_1, CASES["sphere"].printed.f_1, atol=2e-3)
    np.testing.assert_allclose(f_2, CASES["sphere"].printed.f_2, atol=2e-3)
    assert len(q) == len(q_r) == 2


@pytest.mark.paper
def test_printed_forces_sum_to_the_weight() -> None:
    """Table 5, up to the rounding of three digits."""
    for case in CASES.values():
        total = np.add(case.printed.f_1, case.printed.f_2)
        np.testing.assert_allclose(total, [-2.0, 0.0, 0.0], atol=2e-3)


def test_marks_are_judged(ball: Case, result: pinograsp.Result) -> None:
    U = f"{result.ranked('U')[0].cost.U:.6g}"
    found = list(tables.judge(ball, result).values())
    assert found == ["100.0 %: reached", "100.0 %: reached", f"{U}: missed"]
    for least, most, word in ((0.0, 3.0, "reached"), (2.6, 3.0, "missed")):  # a U below what is possible is no success
        marks = dataclasses.replace(ball.marks, least_U=least, most_U=most)
        assert list(tables.judge(dataclasses.replace(ball, marks=marks), result).values())[-1] == f"{U}: {word}"
    nothing = dataclasses.replace(result, grasps=(), verified=0)
    assert all(value.endswith("missed") for value in tables.judge(ball, nothing).values())
    assert "best grasp at most 0.02 mm inside the object" in tables.judge(CASES["case2"], result)


def test_costs_count_merged_grasps(result: pinograsp.Result) -> None:
    first, *others = result.grasps
    merged = dataclasses.replace(result, grasps=(dataclasses.replace(first, count=3), *others))
    costs = runs.costs(merged)
    assert len(costs) == sum(grasp.count for grasp in merged.grasps)
    assert costs == sorted(costs)
    assert runs.near_best([100.0, 101.9, 102.1], 100.0) == 2


def test_without_a_browser_the_page_says_why(
    toy: pinograsp.Robot, ball: Case, result: pinograsp.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(*_: object, **__: object) -> None:
        raise FileNotFoundError("none of chromium was found")

    monkeypatch.setattr(figures, "screenshot", missing)
    assert result.best is not None
    reason = photograph(result.best, tmp_path / "pictures" / "grasp.png", ball.title)
    assert reason == "none of chromium was found"
    assert (tmp_path / "pictures" / "grasp.html").is_file()


def test_damaged_and_foreign_data_are_computed_again(session: Session, tmp_path: Path) -> None:
    store = Store(tmp_path)
    assert store.data("x", {"a": 1}, lambda: [1]) == [1]
    assert store.data("x", {"a": 1}, lambda: [2]) == [1]
    assert store.data("x", {"a": 2}, lambda: [3]) == [3]
    assert Store(tmp_path, fresh=True).data("x", {"a": 2}, lambda: [4]) == [4]
    made = json.loads((tmp_path / "x.json").read_text())["made"]
    assert {"pinograsp", "commit", "cores", "processor", "python"} == set(made)


def test_page_escapes_and_aligns(tmp_path: Path) -> None:
    blocks = [Heading(2, "a < b"), Table(("n", "what"), [("1 (2.0 %)", "`x` | y"), ("-", "3")]), Pictures(())]
    markdown, html = (file.read_text() for file in write_page(tmp_path, "p", "t", blocks))
    assert r"| 1 (2.0 %) | `x` \| y |" in markdown
    assert "<h2>a &lt; b</h2>" in html
    assert "<td class='number'>1 (2.0 %)</td><td><code>x</code> | y</td>" in html


def test_attempts_table_shares_one_best() -> None:
    found = {("a",): [Attempt(0, 2.0, 10, 0.5), Attempt(1, None, 30, 1.5)], ("b",): [Attempt(0, 90.0, 5, 1.0)]}
    rows = attempts_table(found, ("method",)).rows
    assert rows[0] == ("a", "50.0 %", "50.0 %", "2", "20", "1000.0", "0.5")
    assert rows[1][1:4] == ("100.0 %", "0.0 %", "90")


def test_weight_is_part_of_the_key(toy: pinograsp.Robot) -> None:
    case = CASES["case2"]
    scene = pinograsp.load_scene(case.scene)
    heavy = sweep.with_weight(scene, case, 10.0)
    assert heavy.task(case.task).force_weight == 10.0
    assert scene.task(case.task).force_weight == 1.0
    assert key_of(toy, scene, case.task) != key_of(toy, heavy, case.task)


def test_trade_off_is_drawn(tmp_path: Path) -> None:
    file = tmp_path / "pictures" / "weights.png"
    figures.draw_trade_off({"r": [(0.1, 260.0, 2.2), (10.0, 270.0, 2.18)]}, file)
    assert file.read_bytes().startswith(b"\x89PNG")


def test_solvers_are_compared(ball_session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(comparison, "PRICED", 1)
    monkeypatch.setattr(pinograsp.SolverOptions, "budget", property(lambda self: min(self.max_evaluations or 30, 30)))
    *_, table, note = comparison.comparison_section(ball_session, 2)
    assert isinstance(table, Table)
    own = [row[:2] for row in table.rows if row[3] == comparison.OWN]
    assert own == [(kind, solver) for kind in ("projected", "raw") for solver in ("LD_SLSQP", "LN_COBYLA")]
    assert sum(row[3] == comparison.EQUAL for row in table.rows) == 2
    assert isinstance(note, Text)
    assert "without the gradients" in note.text


def test_other_algorithms_run(ball_session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    recipes = tuple(recipe for recipe in algorithms.RECIPES if recipe.algorithm != "GN_ISRES")
    monkeypatch.setattr(algorithms, "RECIPES", recipes)
    monkeypatch.setattr(algorithms, "BUDGET", {True: 20, False: 40})
    *_, table = algorithms.algorithms_section(ball_session, 1)
    assert isinstance(table, Table)
    names = ["the planner", *(recipe.name for recipe in recipes)]
    assert [row[:2] for row in table.rows] == [(kind, name) for kind in ("projected", "raw") for name in names]


def test_equalities_become_pairs_with_slack() -> None:
    slope = np.array([[1.0, 2.0]])
    program = Program(
        start=np.zeros(2),
        lower=np.full(2, -1.0),
        upper=np.full(2, 1.0),
        cost=lambda z: (0.0, np.zeros(2)),
        equalities=lambda z: (slope @ z - 0.3, slope),
        inequalities=lambda z: (z[:1], np.array([[1.0, 0.0]])),
        equality_count=1,
        inequality_count=1,
    )
    pairs = algorithms.with_pairs(program, 0.1)
    assert (pairs.equality_count, pairs.inequality_count) == (0, 3)
    values, jacobian = pairs.inequalities(np.array([0.5, 0.0]))
    np.testing.assert_allclose(values, [0.5, 0.1, -0.3])
    np.testing.assert_array_equal(jacobian, [[1.0, 0.0], [1.0, 2.0], [-1.0, -2.0]])
    assert pairs.equalities(np.zeros(2))[0].shape == (0,)


def test_simple_way_runs(ball_session: Session, result: pinograsp.Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hand_poses, "MOST", 2)
    monkeypatch.setattr(hand_poses, "ANGLES", 4)
    monkeypatch.setattr(alternative, "SEEDS", 2)
    _, _, table = alternative.alternative_section(ball_session, {("toy", "sphere"): result})
    assert isinstance(table, Table)
    ways = [row[2] for row in table.rows]
    assert ways == [
        *("centres on the desired points", "centres or tips there", "centres or tips on a grid"),
        "optimisation, 4 starts",
    ]
    assert table.rows[0][3:5] == ("1", "8")


@pytest.mark.parametrize("first_pad", [0, 1])
def test_inverse_kinematics_puts_the_pads_on_the_points(
    gen3: pinograsp.Robot, sphere_task: TaskModel, first_pad: int
) -> None:
    problem = GraspProblem(sphere_task, (first_pad, 1 - first_pad))
    line = hand_poses.lines(sphere_task)[0]
    rng = np.random.default_rng(0)
    low, high = gen3.lower[: gen3.arm_size], gen3.upper[: gen3.arm_size]
    seeds = rng.uniform(0.5 * low, 0.5 * high, size=(60, gen3.arm_size))
    width = float(np.linalg.norm(line.points[0] - line.points[1]))
    solver = inverse_kinematics.ArmSolver(problem, width, seeds)
    angles = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
    frames = (hand_poses.hand_frame(line.points, angle) for angle in angles)
    postures = [posture for frame in frames for posture in solver.solve(*frame, first_pad, 2)]
    assert len(postures) >= 5
    own = line.points if first_pad == 0 else line.points[::-1]
    for posture in postures:
        x = np.append(posture, solver.contact_parameters(posture, own))
        contacts = problem.state(x).contacts
        np.testing.assert_allclose(contacts.points, own, atol=1e-6)
        inward = (own[::-1] - own) / width
        np.testing.assert_allclose(contacts.normals, inward, atol=1e-6)


def test_lines_begin_at_the_desired_points_and_keep_to_the_region(gen3: pinograsp.Robot) -> None:
    scene = pinograsp.load_scene("glovebox_can")
    free, limited = (hand_poses.lines(TaskModel(gen3, scene, task)) for task in ("can", "can_region"))
    assert free[0].phi_mm2 == pytest.approx(0.0, abs=1e-9)
    assert limited[0].phi_mm2 == pytest.approx(2 * 34.0**2)  # the lower edge of the band
    for lines in (free, limited):
        costs = [line.phi_mm2 for line in lines]
        assert costs == sorted(costs)
    assert len(free) == hand_poses.MOST > len(limited) > 500
