"""What README.md shows works: its Python runs, its commands and files exist."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from pinograsp import cli
from pinograsp.database import build, cache, sampling

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)
PYTHON = [text for language, text in BLOCKS if language == "python"]
LINES = [
    line.strip() for language, text in BLOCKS if language in {"", "sh", "bash", "console"} for line in text.splitlines()
]
COMMANDS = [line for line in LINES if re.match(r"(\$ )?(\S*/)?pinograsp ", line)]
TARGETS = re.findall(r"\bmake ([a-z][\w-]*)", "\n".join(LINES))


def test_python_of_the_readme_runs(tmp_path: Path) -> None:
    assert PYTHON, "README.md shows no Python"
    script = tmp_path / "readme.py"
    script.write_text("\n".join(PYTHON).replace("starts=1304", "starts=24"))
    done = subprocess.run(
        [sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert re.search(r"U = 2\.1[78]", done.stdout)


def test_readme_shows_commands() -> None:
    assert COMMANDS
    assert any(" plan " in command for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_command_of_the_readme_is_understood(command: str) -> None:
    name, *arguments = shlex.split(command.removeprefix("$ "), comments=True)[1:]
    known = typer.main.get_command(cli.app)
    while hasattr(known, "commands"):
        assert name in known.commands
        known = known.commands[name]
        if hasattr(known, "commands"):
            name, *arguments = arguments
    known.make_context(name, arguments)  # exits with 2 on an unknown option or a bad value


def test_your_own_robot(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """The transcript: every command runs, and prints what is shown, in this order (... stands for any lines)."""
    (transcript,) = (text for language, text in BLOCKS if language == "console")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    for module in (build, sampling):  # a small database, so that it takes seconds
        monkeypatch.setattr(module, "DRAWS", 16_384)
    monkeypatch.setattr(cache, "SIZE", 100)
    for step in transcript.split("$ ")[1:]:
        command, *shown = step.strip().splitlines()
        arguments = shlex.split(command.replace("--starts 100", "--starts 12 --workers 1"))
        monkeypatch.setattr(sys, "argv", arguments)
        with pytest.raises(SystemExit) as ended:
            cli.main()
        output = capsys.readouterr().out
        assert ended.value.code in {None, 0}, output
        printed = [line.strip() for line in output.splitlines()]
        if "..." not in shown:
            assert printed == shown
        found = [printed.index(line) for line in shown if line != "..."]
        assert found == sorted(found)


@pytest.mark.parametrize("target", TARGETS)
def test_make_target_of_the_readme_exists(target: str) -> None:
    assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(), flags=re.MULTILINE)


@pytest.mark.parametrize(
    "place", sorted(set(re.findall(r"(?:`|\]\()((?:pinograsp|robots|scenes|tools)/[\w./-]*)[`)]", README)))
)
def test_place_of_the_readme_exists(place: str) -> None:
    assert (ROOT / place).exists()
