"""What Numba keeps between runs must never be older than the source.

It looks at the file of a function alone to see whether what it kept still holds. So a compiled function may call
compiled functions and read constants of its own file only, and these constants must not come from other files.
"""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest

import pinograsp
from pinograsp.compiled import compiled, compiling
from pinograsp.progress import Progress

PACKAGE = Path(pinograsp.__file__).parent
SOURCES = sorted(path for path in PACKAGE.rglob("*.py") if "@compiled" in path.read_text())


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_compiled_functions_know_only_their_own_file(path: Path) -> None:
    tree = ast.parse(path.read_text())
    foreign = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.level
        for alias in node.names
    }
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef) and is_compiled(node)]
    assert functions
    used = {name for function in functions for line in function.body for name in names(line)}
    assert not used & foreign
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if used & {name for target in targets for name in names(target)}:
                assert not names(node) & foreign, ast.unparse(node)


def is_compiled(function: ast.FunctionDef) -> bool:
    return any(name.startswith("compiled") for decorator in function.decorator_list for name in names(decorator))


def names(node: ast.AST) -> set[str]:
    """Return the names in a piece of code, annotations of variables left out."""
    annotations = {id(inner) for outer in ast.walk(node) for inner in inside_annotation(outer)}
    return {inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name) and id(inner) not in annotations}


def inside_annotation(node: ast.AST) -> list[ast.AST]:
    return list(ast.walk(node.annotation)) if isinstance(node, ast.AnnAssign) else []


def test_without_a_folder_to_keep_it_in_a_function_is_compiled_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    njit = numba.njit

    def refuse(cache: bool = False, **options: Any) -> Any:
        if cache:
            raise RuntimeError("cannot cache function 'twice': no locator available for file 'twice.py'")
        return njit(**options)

    with monkeypatch.context() as patch:
        patch.setattr(numba, "njit", refuse)
        invert = compiled(lambda x: 1.0 / x)
    assert invert(0.0) == np.inf


def test_what_names_types_that_have_moved_is_compiled_anew(tmp_path: Path) -> None:
    """Numba keeps types of arguments by name: where another version had them elsewhere, that is no error."""
    kept = tmp_path / "cache"
    source = "from typing import NamedTuple\nclass {name}(NamedTuple):\n    x: float\n"
    source += "from pinograsp.compiled import compiled\n@compiled\ndef twice(one):\n    return 2.0 * one.x\n"
    for name in ("Former", "Latter"):
        (tmp_path / "moving.py").write_text(source.format(name=name))
        os.utime(tmp_path / "moving.py", (1e9, 1e9))  # as old as what was kept says
        found = subprocess.run(
            [sys.executable, "-c", f"import moving; print(moving.twice(moving.{name}(1.5)))"],
            env={**os.environ, "NUMBA_CACHE_DIR": str(kept), "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])},
            capture_output=True,
            text=True,
        )
        assert found.stdout == "3.0\n", found.stderr
    assert list(kept.rglob("*.nbi"))


def test_only_what_is_compiled_now_is_reported() -> None:
    double, triple, seen = numba.njit(lambda x: 2.0 * x), numba.njit(lambda x: 3.0 * x), list[Progress]()
    with compiling(seen.append):
        double(1.0)
        double(2.0)
    assert seen == [Progress("compiling", 0), Progress("compiling", 1)]
    triple(1.0)  # nobody listens any more
    assert len(seen) == 2


INTERPRETED = """
import numpy as np, pinograsp
from pinograsp.problem import GraspProblem, TaskModel
model = TaskModel(pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox_can"), "can")
problem = GraspProblem(model, (0, 1))
here = problem.evaluate(0.4 * problem.lower + 0.6 * problem.upper)
parts = [here.cost_gradient, *here.equalities, *here.inequalities]
print(repr([float(here.cost), *np.concatenate([part.ravel() for part in parts]).tolist()]))
"""


def test_compiled_is_what_the_source_says() -> None:
    """One evaluation with Numba and one with plain Python give the same numbers."""
    fast, slow = (
        subprocess.run(
            [sys.executable, "-c", INTERPRETED],
            env={"PATH": "", "NUMBA_DISABLE_JIT": off, "PINOGRASP_CACHE": os.environ["PINOGRASP_CACHE"]},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for off in ("0", "1")
    )
    first, second = np.array(ast.literal_eval(fast)), np.array(ast.literal_eval(slow))
    assert len(first) > 100
    np.testing.assert_allclose(first, second, rtol=1e-7, atol=1e-9 * np.abs(first).max())
