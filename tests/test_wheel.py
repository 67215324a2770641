"""The wheel, installed in an environment of its own that knows nothing of the repository.

Dependencies are those of the environment that runs the tests, inherited; so nothing is fetched.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path
from typing import NamedTuple

import pytest
from test_files import as_anybody

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]


class Installed(NamedTuple):
    """The environment, and a folder outside of everything."""

    wheel: Path
    sdist: Path
    python: Path
    folder: Path

    def run(self, *command: str, **changed: str) -> subprocess.CompletedProcess[str]:
        """Run a command with warnings as errors, without the repository on the path."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        environment = kept | {"PYTHONWARNINGS": "error"} | changed
        return subprocess.run(
            command, cwd=self.folder, env=environment, capture_output=True, text=True, check=False, timeout=600
        )


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-d", str(folder / "dist")], cwd=ROOT, check=True)
    (wheel,), (sdist,) = (folder / "dist").glob("*.whl"), (folder / "dist").glob("*.tar.gz")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder / "venv")], check=True)
    python = folder / "venv" / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", "--python", str(python)]
    subprocess.run([*pip, "install", "--no-deps", "--no-index", str(wheel)], check=True)
    (packages,) = (folder / "venv" / "lib").glob("python*/site-packages")
    (packages / "inherited.pth").write_text(f"import site; site.addsitedir({sysconfig.get_path('purelib')!r})\n")
    (folder / "elsewhere").mkdir()
    return Installed(wheel, sdist, python, folder / "elsewhere")


def test_what_is_in_it(installed: Installed) -> None:
    wheel = set(zipfile.ZipFile(installed.wheel).namelist())
    with tarfile.open(installed.sdist) as archive:
        sdist = {name.partition("/")[2] for name in archive.getnames()}
    for name in ("py.typed", "__init__.pyi", "__main__.py"):
        assert f"pinograsp/{name}" in wheel & sdist
    for kind in ("robots", "scenes"):
        files = {str(file.relative_to(ROOT)) for file in (ROOT / kind).rglob("*.yaml")}
        assert files and files <= sdist
        assert {f"pinograsp/data/{file}" for file in files} <= wheel
    assert not [name for name in wheel if name.startswith(("tests/", "tools/"))]


def test_it_is_what_is_imported(installed: Installed) -> None:
    done = installed.run(str(installed.python), "-c", "import pinograsp; print(pinograsp.__file__)")
    assert Path(done.stdout.strip()).is_relative_to(installed.python.parents[1]), done.stderr
    done = installed.run(
        str(installed.python), "-c", "import pinograsp; print(*pinograsp.shipped_scenes().values(), sep='\\n')"
    )
    assert all(Path(file).is_relative_to(installed.python.parents[1]) for file in done.stdout.split())


@pytest.mark.parametrize("command", [("pinograsp",), ("python", "-m", "pinograsp")])
def test_plan(installed: Installed, command: tuple[str, ...]) -> None:
    first, *further = command
    shutil.rmtree(installed.folder / "out", ignore_errors=True)
    plan = ("plan", "glovebox", "--task", "sphere", "--starts", "8", "--workers", "1")
    done = installed.run(str(installed.python.parent / first), *further, *plan)
    assert done.returncode == 0, done.stderr
    assert "Warning" not in done.stderr
    assert list((installed.folder / "out").glob("*.json"))
    assert list((installed.folder / "out").glob("*.html"))


def test_nothing_can_be_written_but_the_results(installed: Installed, tmp_path: Path) -> None:
    """Neither beside the package nor in the home folder: it works from a start database, and nothing else is kept."""
    folder = installed.folder / "results"
    folder.mkdir(mode=0o700)
    home = tmp_path / "home"
    home.mkdir(mode=0o500)
    database = tmp_path / "box.duckdb"
    build = (
        "import sys, pinograsp\n"
        "robot, scene = pinograsp.load_robot('gen3_2f85'), pinograsp.load_scene('glovebox')\n"
        "pinograsp.build_database(robot, scene, sys.argv[1], size=9000).close()\n"
    )
    assert installed.run(str(installed.python), "-c", build, str(database)).returncode == 0
    plan = (installed.python.parent / "pinograsp", "plan", "glovebox", "--task", "sphere", "--starts", "4")
    where = ("--out", folder, "--workers", "1")
    package = next((installed.python.parents[1] / "lib").glob("python*/site-packages/pinograsp"))
    closed = [package, *(part for part in package.rglob("*") if part.is_dir())]
    for part in closed:
        part.chmod(0o500)
    try:
        no_cache = {"HOME": str(home), "PINOGRASP_CACHE": ""}
        done = installed.run(*as_anybody(*plan, *where, "--database", database), **no_cache)
        refused = installed.run(*as_anybody(*plan, *where), **no_cache)
    finally:
        for part in closed:
            part.chmod(0o700)
    assert done.returncode == 0, done.stderr
    assert list(folder.glob("*.json"))
    assert not list(home.iterdir())
    assert refused.returncode == 2
    assert "the cache folder cannot be written" in refused.stderr
    assert "Traceback" not in refused.stderr


def test_a_strictly_typed_script(installed: Installed) -> None:
    """The package's annotations reach a user's `mypy --strict`; a wrong use is found."""
    script = installed.folder / "script.py"
    right = (Path(__file__).parent / "user_script.py").read_text()
    options = ("--strict", "--config-file=", "--python-executable", str(installed.python), "--cache-dir=mypy")
    mypy = (sys.executable, "-m", "mypy", *options, script.name)
    script.write_text(right)
    done = installed.run(*mypy, PYTHONWARNINGS="default")
    assert done.returncode == 0, done.stdout + done.stderr
    script.write_text(right + "\nwrong: int = pinograsp.load_scene('glovebox')\n")
    done = installed.run(*mypy, PYTHONWARNINGS="default")
    assert 'expression has type "Scene"' in done.stdout
