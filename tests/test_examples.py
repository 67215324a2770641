"""The examples of the documentation run, are short, and pass a user's type checker; so runs what its pages show."""

from __future__ import annotations

import json
import runpy
import subprocess
import sys
from pathlib import Path

import meshes
import pytest
from IPython.core.interactiveshell import InteractiveShell
from test_readme import blocks

import pinograsp
from pinograsp.database import build, cache, sampling

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "docs" / "examples"
NOTEBOOK = EXAMPLES / "notebook.ipynb"
SAID = {
    "first_plan": "U = 2.17",
    "own_urdf": "0.0 to 80.0 mm apart",
    "object_poses": "a grasp at 2 of 2 poses",
    "own_configuration": "no grasp",
    "locked_joint": "joint_1 at  0.0000 rad",
    "another_order": "none is better in all three",
    "painted_mug": "starts verified, on the paint alone",
}
"""Something that each example prints; a new example has a line here."""
FEW = {"object_poses": 2, "painted_mug": 4}
"""Arguments of `main`, where they are not 12 starts."""


UNTOLD = {"many_machines.md"}
"""Pages whose Python needs what a test does not have: other machines."""
LESS = {'task="sphere")': 'task="sphere", starts=12, workers=1)', "samples=100": "samples=4", "best=20": "best=1"}
"""What pages ask for, and what is enough to see that it runs."""
PAGES = [
    page
    for page in sorted((ROOT / "docs").rglob("*.md"))
    if page.name not in UNTOLD and any("--8<--" not in text for text in blocks(page, "python"))
]


def code_cells() -> list[str]:
    """Return the code of the notebook, cell by cell."""
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


@pytest.fixture(autouse=True)
def small_databases(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Examples take seconds, and write where nobody minds."""
    monkeypatch.chdir(tmp_path)
    for module in (build, sampling):
        monkeypatch.setattr(module, "DRAWS", 16_384)
    monkeypatch.setattr(cache, "SIZE", 4_000)


def test_every_example_is_run() -> None:
    assert {file.stem for file in EXAMPLES.glob("*.py")} == set(SAID)


@pytest.mark.parametrize("name", SAID)
def test_an_example_runs(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(EXAMPLES / f"{name}.py"))["main"](FEW.get(name, 12))
    assert SAID[name] in capsys.readouterr().out


@pytest.mark.parametrize("name", SAID)
def test_an_example_is_short(name: str) -> None:
    assert len((EXAMPLES / f"{name}.py").read_text().splitlines()) <= 40


def test_the_notebook_runs_and_shows_tables() -> None:
    assert sum(len(cell.splitlines()) for cell in code_cells()) <= 40
    shell = InteractiveShell()
    shown = []
    for cell in code_cells():
        done = shell.run_cell(cell.replace("STARTS = 200", "STARTS = 12"))
        done.raise_error()
        shown.append(done.result)
    kinds = (pinograsp.Scene, pinograsp.Result, pinograsp.Grasp, pinograsp.Certificate, pinograsp.ConfigurationCheck)
    for kind in kinds:
        (value,) = (value for value in shown if type(value) is kind)
        assert "<table" in value._repr_html_()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_python_of_a_page_runs(page: Path) -> None:
    """After a first plan, with a mesh in a folder: pages go on from there."""
    robot, scene = pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox")
    result = pinograsp.plan(robot, scene, task="sphere", starts=12, workers=1)
    Path("out").mkdir()
    Path("meshes").mkdir()
    meshes.written(meshes.mug(), Path("meshes/mug.glb"))
    pinograsp.write_json(result, "out/glovebox_sphere_gen3_2f85.json")
    known = {"pinograsp": pinograsp, "robot": robot, "scene": scene, "result": result, "best": result.best}
    for text in blocks(page, "python"):
        if "--8<--" not in text:
            for shown, quick in LESS.items():
                text = text.replace(shown, quick)
            exec(compile(text, str(page), "exec"), known)


def test_examples_pass_a_users_type_checker(tmp_path: Path) -> None:
    """Without the configuration of this repository, as `mypy --strict` of a user's own script."""
    notebook = tmp_path / "notebook.py"
    notebook.write_text("\n".join(code_cells()))
    files = [*map(str, sorted(EXAMPLES.glob("*.py"))), str(notebook)]
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", f"--cache-dir={tmp_path / 'cache'}"]
    done = subprocess.run([*command, *files], cwd=ROOT, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout
