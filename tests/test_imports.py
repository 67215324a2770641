"""What is loaded when: nothing before it is used, and no library of robots for what only reads."""

from __future__ import annotations

import ast
import importlib.metadata
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from conftest import HEAVY

import pinograsp
from pinograsp import Result, Robot, Scene, write_json

UNUSED = (*HEAVY, "rich", "typer")
"""What Python does not load before it is used."""


def run(script: str, *arguments: str) -> list[str]:
    """Run a script in a fresh interpreter, with warnings as errors, and return the lines that it prints."""
    command = [sys.executable, "-W", "error", "-c", script, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout.splitlines()


def heavy_after(script: str, *arguments: str) -> list[str]:
    """Return the heavy libraries that are loaded after a script."""
    ask = f"\nimport json, sys\nprint(json.dumps([name for name in {UNUSED} if name in sys.modules]))"
    found: list[str] = json.loads(run(script + ask, *arguments)[-1])
    return found


@pytest.fixture(scope="module")
def file(gen3: Robot, glovebox: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    result = pinograsp.plan(gen3, glovebox, "sphere", starts=6, workers=1)
    assert result.grasps
    written = tmp_path_factory.mktemp("results") / "result.json"
    write_json(result, written)
    return written


BROUGHT = {"coal": "coal", "pinocchio": "pin", "pydantic_core": "pydantic"}
"""Modules whose distributions do not list them, or which come with one as its documented other half."""


def test_every_library_that_is_imported_is_declared() -> None:
    """A dependency of a dependency may go away."""
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
    users = [*project["dependencies"], *project["optional-dependencies"]["hold"]]
    declared = {re.split(r"[\[<>=]", given)[0].lower() for given in users}
    distributions = importlib.metadata.packages_distributions()
    for file in Path(pinograsp.__file__).parent.rglob("*.py"):
        for module in _imported(file) - {*sys.stdlib_module_names, "pinograsp"}:
            brought = [BROUGHT[module]] if module in BROUGHT else distributions[module]
            assert declared & {name.lower().replace("_", "-") for name in brought}, f"{file.name} imports {module}"


def _imported(file: Path) -> set[str]:
    """Return the top-level modules that a file imports, within its functions too."""
    nodes = list(ast.walk(ast.parse(file.read_text())))
    names = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    names += [str(node.module) for node in nodes if isinstance(node, ast.ImportFrom) and not node.level]
    return {name.partition(".")[0] for name in names}


def test_importing_loads_no_module_of_the_package() -> None:
    ask = "import sys, pinograsp; print(*sorted(name for name in sys.modules if name.startswith('pinograsp')))"
    assert run(ask) == ["pinograsp"]
    assert heavy_after("import pinograsp, sys; assert 'numpy' not in sys.modules") == []


READ = """
import sys
import pinograsp
result = pinograsp.read_json(sys.argv[1])
best = result.best
assert best is not None and result.ranked("U")[0].cost.U <= best.cost.U
assert result.pareto() and result.different(3)
assert best.certificate.verified and best.certificate["joint reserve"].value > 0.0
assert best.claim.points.shape == (2, 3) and best.contacts[0].pad and result.blocked is not None
assert result.setup.scene.task(result.task).desired_contacts and result.setup.robot.arm.joints
pinograsp.write_json(result, sys.argv[1] + ".copy")
"""


def test_reading_a_result_loads_no_heavy_library(file: Path) -> None:
    assert heavy_after(READ, str(file)) == []
    assert Path(f"{file}.copy").read_bytes() == file.read_bytes()


def test_scenes_load_no_heavy_library() -> None:
    script = (
        "import pinograsp\n"
        "for name in pinograsp.shipped_scenes(): pinograsp.load_scene(name)\n"
        "pinograsp.shipped_robots(), pinograsp.schema('robot'), pinograsp.schema('scene')\n"
        "pinograsp.Pose(position=(0, 0, 0)), pinograsp.Sphere, pinograsp.HalfSpace, pinograsp.SoftFinger\n"
    )
    assert heavy_after(script) == []


def test_robot_files_load_no_heavy_library() -> None:
    script = "from pinograsp.descriptions import load_robot_description\nload_robot_description('gen3_2f85')"
    assert heavy_after(script) == []


@pytest.mark.parametrize(
    "name",
    [
        "Assessment",
        "Certificate",
        "Claim",
        "Derived",
        "Errors",
        "Figure",
        "HoldOptions",
        "HoldOutcome",
        "Margin",
        "RobotDescription",
        "SolverOptions",
        "Verdict",
    ],
)
def test_data_types_load_no_heavy_library(name: str) -> None:
    assert heavy_after(f"import pinograsp; pinograsp.{name}") == []


def test_errors_load_nothing() -> None:
    assert run("import sys, pinograsp; pinograsp.InputError; print('numpy' in sys.modules)") == ["False"]


def test_visualization_loads_on_use(file: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    script = (
        "import sys, pinograsp\n"
        "print('pinograsp.visualization' in sys.modules)\n"
        "pinograsp.visualization.write_html(pinograsp.read_json(sys.argv[1]), sys.argv[2])\n"
        "print('pinograsp.visualization' in sys.modules)"
    )
    assert run(script, str(file), str(page)) == ["False", "True"]
    assert page.stat().st_size > 0


def test_names_are_those_of_the_modules() -> None:
    """The lazy name and the name in its module are one object: `except` and `isinstance` work with either."""
    from pinograsp.errors import InputError
    from pinograsp.results.result import Result as Defined

    assert pinograsp.InputError is InputError
    assert Result is Defined


def test_unknown_names_are_attribute_errors() -> None:
    with pytest.raises(AttributeError, match="plann"):
        _ = pinograsp.plann
