"""The wheel, installed in environments that hold what it declares and nothing else.

Dependencies come from the package index, or from the caches of pip and uv.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path
from typing import NamedTuple

import pytest
from test_files import as_anybody

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
VERSIONS = ("3.11", "3.12", "3.13")
"""Of Python, those of the classifiers in `pyproject.toml`."""
PLAN = ("plan", "glovebox", "--task", "sphere", "--starts", "8", "--workers", "1")


class Built(NamedTuple):
    """The two archives."""

    wheel: Path
    sdist: Path


class Installed(NamedTuple):
    """The interpreter of an environment, and a folder outside of everything."""

    python: Path
    folder: Path

    def run(self, *command: str, **changed: str) -> subprocess.CompletedProcess[str]:
        """Run a command with warnings as errors, without the repository on the path."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        environment = kept | {"PYTHONWARNINGS": "error"} | changed
        return subprocess.run(
            command, cwd=self.folder, env=environment, capture_output=True, text=True, check=False, timeout=600
        )

    def plan(self, *command: str) -> None:
        """Plan a few starts: a table, two files, and no warning."""
        shutil.rmtree(self.folder / "out", ignore_errors=True)
        done = self.run(*command, *PLAN)
        assert done.returncode == 0, done.stderr
        assert "8 of 8 starts verified" in done.stdout
        assert "Warning" not in done.stderr
        assert list((self.folder / "out").glob("*.json"))
        assert list((self.folder / "out").glob("*.html"))


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-d", str(folder)], cwd=ROOT, check=True)
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    return Built(wheel, sdist)


@pytest.fixture(scope="module")
def installed(built: Built, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    return environment(sys.executable, built.wheel, tmp_path_factory.mktemp("wheel"))


def environment(interpreter: str, wheel: Path, folder: Path) -> Installed:
    """Return an environment into which pip has installed the wheel and what it declares."""
    subprocess.run([interpreter, "-m", "venv", str(folder / "venv")], check=True)
    python = folder / "venv" / "bin" / "python"
    pip = [str(python), "-m", "pip", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "install", str(wheel)], check=True)
    (folder / "elsewhere").mkdir()
    return Installed(python, folder / "elsewhere")


def interpreter(version: str) -> str | None:
    """Return a Python of a version that is there: on the path, or among those of pyenv."""
    pyenv = Path(os.environ.get("PYENV_ROOT", "~/.pyenv")).expanduser()
    found = [f"python{version}", *map(str, sorted(pyenv.glob(f"versions/{version}.*/bin/python")))]
    return next(filter(_works, found), None)


def _works(command: str) -> bool:
    try:
        return subprocess.run([command, "-c", ""], capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        return False


def test_what_is_in_it(built: Built) -> None:
    wheel = set(zipfile.ZipFile(built.wheel).namelist())
    with tarfile.open(built.sdist) as archive:
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
    installed.plan(str(installed.python.parent / first), *further)


@pytest.mark.parametrize("version", VERSIONS)
def test_every_version_of_python_that_is_there(built: Built, version: str, tmp_path: Path) -> None:
    python = interpreter(version)
    if python is None:
        pytest.skip(f"there is no Python {version}")
    made = environment(python, built.wheel, tmp_path)
    assert made.run(str(made.python), "--version").stdout.startswith(f"Python {version}.")
    made.plan(str(made.python.parent / "pinograsp"))


def test_uv(built: Built, tmp_path: Path) -> None:
    """In an environment that it makes, and as a tool that is run once."""
    if shutil.which("uv") is None:
        pytest.skip("there is no uv")
    python = tmp_path / "venv" / "bin" / "python"
    subprocess.run(["uv", "venv", "--quiet", "--python", sys.executable, str(tmp_path / "venv")], check=True)
    subprocess.run(["uv", "pip", "install", "--quiet", "--python", str(python), str(built.wheel)], check=True)
    made = Installed(python, tmp_path)
    made.plan(str(python.parent / "pinograsp"))
    made.plan("uv", "tool", "run", "--quiet", "--python", sys.executable, "--from", str(built.wheel), "pinograsp")


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
    script.write_text(right + "\nwrong: int = pinograsp.load_scene('glovebox')\npinograsp.Pose(position='up')\n")
    done = installed.run(*mypy, PYTHONWARNINGS="default")
    assert 'expression has type "Scene"' in done.stdout
    assert 'Argument "position" to "Pose" has incompatible type "str"' in done.stdout
