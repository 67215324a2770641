"""What README.md shows works: its Python runs, its commands and files exist; and so do transcripts of the pages."""

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
README = ROOT / "README.md"
TEXTS = [README, ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(file: Path, *languages: str) -> list[str]:
    """Return the blocks of code in some languages, without their indentation in tabs."""
    found = re.findall(r"^( *)```(\w*)\n(.*?)^ *```$", file.read_text(), flags=re.MULTILINE | re.DOTALL)
    return [re.sub(rf"^{indent}", "", text, flags=re.MULTILINE) for indent, name, text in found if name in languages]


LINES = {
    file: [line.strip() for text in blocks(file, "", "sh", "bash", "console") for line in text.splitlines()]
    for file in TEXTS
}
COMMANDS = {
    file: [line.removeprefix("$ ") for line in lines if re.match(r"(\$ )?(\S*/)?pinograsp ", line)]
    for file, lines in LINES.items()
}
TARGETS = sorted({name for lines in LINES.values() for name in re.findall(r"\bmake ([a-z][\w-]*)", "\n".join(lines))})
TRANSCRIPTS = [file for file in TEXTS if blocks(file, "console")]


def test_python_of_the_readme_runs(tmp_path: Path) -> None:
    script = tmp_path / "readme.py"
    script.write_text("\n".join(blocks(README, "python")).replace("starts=1304", "starts=24"))
    done = subprocess.run(
        [sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert [line for line in done.stderr.splitlines() if "once on this machine" not in line] == []
    assert re.search(r"U = 2\.1[78]", done.stdout)


def test_readme_shows_commands() -> None:
    assert any(" plan " in command for command in COMMANDS[README])


@pytest.mark.parametrize("command", sorted({command for commands in COMMANDS.values() for command in commands}))
def test_a_command_is_understood(command: str) -> None:
    name, *arguments = shlex.split(command, comments=True)[1:]
    arguments = arguments[: arguments.index(">")] if ">" in arguments else arguments
    known = typer.main.get_command(cli.app)
    while hasattr(known, "commands"):
        assert name in known.commands
        known = known.commands[name]
        if hasattr(known, "commands"):
            name, *arguments = arguments
    known.make_context(name, arguments)  # exits with 2 on an unknown option or a bad value


@pytest.mark.parametrize("file", TRANSCRIPTS, ids=lambda file: file.name)
def test_a_transcript(
    file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Every command runs, and prints what is shown, in this order (... stands for any lines)."""
    (transcript,) = blocks(file, "console")
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
def test_a_make_target_exists(target: str) -> None:
    assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(), flags=re.MULTILINE)


PLACES = {
    place
    for file in TEXTS
    for place in re.findall(r"`((?:docs|pinograsp|robots|scenes|tests|tools)/[\w./-]*)`", file.read_text())
}


@pytest.mark.parametrize("place", sorted(PLACES))
def test_a_place_exists(place: str) -> None:
    assert (ROOT / place).exists()
