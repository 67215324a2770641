"""Machines that misbehave: whether commands keep what they found, say what is wrong, and leave nothing behind.

    python tools/faults.py [--moments 50] [--seed 0] [--parts signals workers folders terminals shared]
        [--commands plan build report] [--processes 2]

Signals come at random moments of `plan`, `database build` and `rank` (of a page), from the first import on; SIGINT to
the whole group, as a terminal sends it. Then workers are killed, folders are read-only, full, missing, or a file;
terminals are closed, of ASCII, or full; and many plans begin at once on an empty cache. Prints a Markdown table of the
outcomes; exit code 1 if one is wrong, and what was wrong on standard error. Full and read-only folders need the right
to mount a tmpfs, and are left out without it.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import duckdb

import pinograsp

BEGIN = """
import os, sys
os.close(int(sys.argv.pop(1)))  # the first import begins
from pinograsp.__main__ import main
main()
"""
STARTS = 40
ROWS = 20_000
NAME = "glovebox_sphere_gen3_2f85"
PLAN = ("plan", "glovebox", "--task", "sphere", "--starts", STARTS)
BUILD = ("database", "build", "rows.duckdb", "--scene", "glovebox", "--size", ROWS)
REPORT = ("rank", "result.json", "--out", "out")
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)
SAID = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}
"""Exit codes of commands that were asked to end."""
NOBODY = 54321
"""A user of whom the system knows nothing."""
TIMEOUT = 300.0
"""Seconds after which a command is taken to hang."""
HANGS = 1000
"""Its exit code then."""


class WrongError(Exception):
    """An outcome that should not be."""


@dataclass
class Done:
    """What became of a command."""

    code: int
    output: str
    errors: str
    seconds: float
    left: list[int] = field(default_factory=list)
    """Processes of its group that were still there a few seconds after it."""

    def require(self, *codes: int) -> Done:
        """Refuse another exit code, a traceback, and processes that are left."""
        said = self.output + self.errors
        if self.code not in codes or "Traceback" in said or "Exception ignored" in said or self.left:
            left = f", left {self.left}" if self.left else ""
            raise WrongError(f"exit code {self.code}{left}: {said.strip()[-1500:]}")
        return self


@dataclass
class Machine:
    """Runs commands in a folder of their own, all with one cache."""

    cache: Path
    processes: int

    def run(
        self,
        folder: Path,
        *words: object,
        at: Callable[[subprocess.Popen[str]], object] = lambda process: None,
        environment: Mapping[str, str | None] | None = None,
        **streams: Any,
    ) -> Done:
        """Run a command.

        Args:
            folder: where it runs.
            words: of the command.
            at: called when its first import begins.
            environment: variables that are set besides, or with None taken away.
            streams: further arguments of `Popen`.
        """
        variables = {"PINOGRASP_CACHE": str(self.cache), **(environment or {})}
        kept = {key: value for key, value in (os.environ | variables).items() if value is not None}
        workers = ("--workers", self.processes) if words[0] in ("plan", "database") else ()
        reading, writing = os.pipe()
        with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as errors:
            began = time.monotonic()
            process = subprocess.Popen(
                [sys.executable, "-c", BEGIN, str(writing), *map(str, (*words, *workers))],
                **{"cwd": folder, "env": kept, "stdout": output, "stderr": errors, "start_new_session": True} | streams,
                pass_fds=(writing,),
                text=True,
            )
            os.close(writing)
            os.read(reading, 1)  # ends where the child closes it
            os.close(reading)
            try:
                at(process)
                code = process.wait(TIMEOUT)
            except subprocess.TimeoutExpired:
                code = HANGS
            except BaseException:
                _kill(process)
                raise
            seconds = time.monotonic() - began
            left = _gone(process.pid)
            if code == HANGS:
                _kill(process)
            texts = []
            for stream in (output, errors):
                stream.seek(0)
                texts.append(stream.read())
        return Done(code, *texts, seconds, left)


def _kill(process: subprocess.Popen[str]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _members(group: int) -> list[int]:
    """Return the living processes of a group."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            state, _, own = (entry / "stat").read_text().rpartition(")")[2].split()[:3]
            if int(own) == group and state != "Z":
                found.append(int(entry.name))
    return found


def _gone(group: int) -> list[int]:
    """Return what is left of a group after some seconds."""
    end = time.monotonic() + 10.0
    while (left := _members(group)) and time.monotonic() < end:
        time.sleep(0.05)
    return left


def _require_clean(*folders: Path) -> None:
    """Refuse temporary files: of a file or database that was written whole, or not at all."""
    for folder in folders:
        found = [p.name for p in folder.rglob(".*") if not p.name.endswith((".lock", ".unfinished"))]
        found += [p.name for p in folder.rglob("*") if p.name.endswith((".partial", ".sorting"))]
        if found:
            raise WrongError(f"left in {folder}: {', '.join(found)}")


# ---- outcomes


def _check_plan(folder: Path, done: Done, number: int | None, whole: Any) -> str:
    """Return the outcome of a plan that a signal of a number, or nothing, has reached."""
    file = folder / "out" / f"{NAME}.json"
    if number == signal.SIGKILL:
        if file.exists():
            pinograsp.read_json(file)
        return "killed" if done.code < 0 else "was done"
    done.require(0, *([SAID[number]] if number else []))
    _require_clean(folder)
    if done.code == 0:
        _require_same(file, whole)
        return "was done"
    reported = [int(n) for n in re.findall(r"starts: (\d+) of", done.errors)]
    if not file.exists():
        if reported or "error: interrupted" not in done.errors:
            raise WrongError(f"nothing written: {done.output}{done.errors}")
        return "nothing to keep"
    result = pinograsp.read_json(file)
    if max(reported, default=0) > result.done or sum(g.count for g in result.grasps) != result.verified:
        raise WrongError(f"{result.done} starts, {result.verified} verified are kept of {reported}")
    if not result.interrupted:
        _require_same(file, whole)
    return "kept" if result.interrupted else "was done"


def _require_same(file: Path, whole: Any) -> None:
    grasps = [grasp.to_json() for grasp in pinograsp.read_json(file).grasps]
    if grasps != whole:
        raise WrongError(f"{len(grasps)} grasps, {len(whole)} without the fault, and not the same")


def _require_interrupted(folder: Path, done: Done, number: int | None) -> None:
    """Want that a command went on to its end, or ended with one line, and left nothing lying about."""
    done.require(0, *([SAID[number]] if number else []))
    _require_clean(folder)
    if done.code and done.errors.count("error: interrupted") != 1:
        raise WrongError(done.errors)


def _check_build(folder: Path, done: Done, number: int | None, whole: Any) -> str:
    """Return the outcome of a build; the same command goes on."""
    if number == signal.SIGKILL:
        return "killed" if done.code < 0 else "was done"
    _require_interrupted(folder, done, number)
    return "kept" if done.code else "was done"


def _check_report(folder: Path, done: Done, number: int | None, whole: Any) -> str:
    """Return the outcome of a page, which is there whole or not at all."""
    pages = list((folder / "out").glob("*.html"))
    if not all(page.read_text().endswith(whole) for page in pages):
        raise WrongError("the page is not whole")
    if number == signal.SIGKILL:
        return "killed" if done.code < 0 else "was done"
    _require_interrupted(folder, done, number)
    return "interrupted" if done.code else "was done"


def _rows(file: Path) -> Any:
    with duckdb.connect(str(file), read_only=True) as connection:
        found = connection.execute("SELECT count(*), sum(hash(sample, q1, x, clearance)) FROM configurations")
        return found.fetchone()


@dataclass
class Subject:
    """A command that faults reach."""

    words: tuple[object, ...]
    check: Callable[[Path, Done, int | None, Any], str]
    whole: Any = None
    seconds: float = 0.0


class Faults:
    """All parts, and the lines of the table."""

    def __init__(self, machine: Machine, folder: Path, moments: int, seed: int, commands: Sequence[str]) -> None:
        self._machine, self._folder, self._moments = machine, folder, moments
        self._random = random.Random(seed)
        self._count = 0
        self.wrong = 0
        self.lines: list[str] = []
        self._subjects = {
            "plan": Subject(PLAN, _check_plan),
            "build": Subject(BUILD, _check_build),
            "report": Subject(REPORT, _check_report),
        }
        self._chosen = {name: self._subjects[name] for name in commands}

    def fresh(self) -> Path:
        """Return a new folder."""
        self._count += 1
        folder = self._folder / str(self._count)
        folder.mkdir()
        return folder

    def prepare(self) -> None:
        """Run every command undisturbed, twice: the first time fills the caches."""
        for name, subject in self._subjects.items():
            seconds = []
            for _ in range(2):
                folder = self._started(name)
                done = self._machine.run(folder, *subject.words).require(0)
                seconds.append(done.seconds)
            subject.seconds = seconds[-1]
            if name == "plan":
                shutil.copy(folder / "out" / f"{NAME}.json", self._folder / "result.json")
                result = pinograsp.read_json(self._folder / "result.json")
                subject.whole = [grasp.to_json() for grasp in result.grasps]
            elif name == "build":
                subject.whole = _rows(folder / "rows.duckdb")
            else:
                subject.whole = next((folder / "out").glob("*.html")).read_text()[-100:]  # names within it are random
            print(f"{name}: {subject.seconds:.1f} s", file=sys.stderr)

    def _started(self, name: str) -> Path:
        folder = self.fresh()
        if name == "report":
            shutil.copy(self._folder / "result.json", folder)
        return folder

    @contextlib.contextmanager
    def row(self, fault: str, command: str) -> Iterator[Counter[str]]:
        """Collect the outcomes of a line of the table."""
        outcomes: Counter[str] = Counter()
        yield outcomes
        said = ", ".join(f"{count} {outcome}" for outcome, count in sorted(outcomes.items()))
        self.lines.append(f"| {fault} | {command} | {outcomes.total()} | {said} | {outcomes['WRONG']} |")
        print(self.lines[-1], file=sys.stderr)
        self.wrong += outcomes["WRONG"]

    @contextlib.contextmanager
    def judged(self, outcomes: Counter[str], where: str) -> Iterator[None]:
        """Count what is wrong in the block."""
        try:
            yield
        except (WrongError, pinograsp.PinograspError, duckdb.Error, OSError) as error:
            outcomes["WRONG"] += 1
            print(f"WRONG, {where}: {type(error).__name__}: {error}", file=sys.stderr)

    # ---- signals

    def signals(self) -> None:
        """Send every signal at random moments of every command."""
        for name, subject in self._chosen.items():
            for number in SIGNALS:
                with self.row(signal.Signals(number).name, name) as outcomes:
                    folder = self._started(name)
                    for _ in range(self._moments):
                        if name != "build":
                            folder = self._started(name)
                        moment = self._random.uniform(0.0, subject.seconds)
                        with self.judged(outcomes, f"{number} after {moment:.3f} s of {name}"):
                            done = self._machine.run(folder, *subject.words, at=_sender(number, moment))
                            outcomes[subject.check(folder, done, number, subject.whole)] += 1
                            if done.code == 0:  # as fast as the machine is now
                                subject.seconds = done.seconds
                        if name == "build" and (folder / "rows.duckdb").exists():
                            self._goes_on(folder, outcomes)

    def _goes_on(self, folder: Path, outcomes: Counter[str]) -> None:
        """Refuse a database that does not open, and now and then build it to its end; then begin another one."""
        subject = self._subjects["build"]
        with self.judged(outcomes, "the build after it"):
            with pinograsp.Database.open(folder / "rows.duckdb") as database:
                database.rows()
            if self._random.random() < 0.25:
                self._machine.run(folder, *subject.words).require(0)
                if _rows(folder / "rows.duckdb") != subject.whole:
                    raise WrongError("other rows than without the fault")
                _require_clean(folder)
                (folder / "rows.duckdb").unlink()

    # ---- workers

    def workers(self) -> None:
        """Kill one worker at random moments: nothing is lost."""
        for name in (name for name in self._chosen if name != "report"):
            subject = self._subjects[name]
            with self.row("a worker is killed", name) as outcomes:
                for _ in range(self._moments):
                    folder, moment = self._started(name), self._random.uniform(0.2, 1.0) * subject.seconds
                    with self.judged(outcomes, f"a worker killed after {moment:.3f} s of {name}"):
                        killed: list[int] = []
                        done = self._machine.run(folder, *subject.words, at=self._killer(moment, killed)).require(0)
                        if name == "build" and _rows(folder / "rows.duckdb") != subject.whole:
                            raise WrongError("other rows than without the fault")
                        subject.check(folder, done, None, subject.whole)
                        outcomes["the same outcome" if killed else "no worker then"] += 1

    def _killer(self, moment: float, killed: list[int]) -> Callable[[subprocess.Popen[str]], None]:
        def kill(process: subprocess.Popen[str]) -> None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(moment)
            workers = [pid for pid in _members(process.pid) if pid != process.pid]
            if workers:
                killed.append(self._random.choice(workers))
                with contextlib.suppress(ProcessLookupError):
                    os.kill(killed[0], signal.SIGKILL)

        return kill

    # ---- folders

    def folders(self) -> None:
        """Give commands a cache or an output folder that cannot be used."""
        kinds: dict[str, Callable[[Path], contextlib.AbstractContextManager[Path]]] = {
            "a file in the way": _file_in_the_way,
            "a file in place of it": _file_in_place,
        }
        if _may_mount(self.fresh()):
            kinds |= {
                "read-only": lambda folder: _mounted(folder, "ro,size=1m"),
                "full at once": lambda folder: _mounted(folder, "size=4k"),
                "full after 1 MB": lambda folder: _mounted(folder, "size=1m"),
            }
        else:
            print("no tmpfs may be mounted: read-only and full folders are left out", file=sys.stderr)
        for kind, made in kinds.items():
            with self.row(f"the cache folder is {kind}", "plan") as outcomes, self.judged(outcomes, f"cache {kind}"):
                folder = self.fresh()
                with made(folder) as cache:
                    self._plans_without(folder, str(cache), {"PINOGRASP_CACHE": str(cache)})
                    if cache.is_dir():
                        _require_clean(cache)
                outcomes["planned, one warning"] += 1
            for name in ("plan", "build", "report"):
                words = self._subjects[name].words
                with self.row(f"the folder of the files is {kind}", name) as outcomes, self.judged(outcomes, kind):
                    folder = self._started(name)
                    with made(folder) as out:
                        if name == "build":
                            words = (*words[:2], out / "rows.duckdb", *words[3:])
                        else:
                            words = (*words, "--out", out)
                        done = self._machine.run(folder, *words)
                        if done.code == 0 and kind == "full after 1 MB":
                            outcomes["there was room"] += 1
                            continue
                        last = done.require(2).errors.strip().splitlines()[-1]
                        if not (last.startswith("error: ") and str(out) in last):
                            raise WrongError(last)
                        if out.is_dir():
                            _require_clean(out)
                    outcomes["one line"] += 1
        homes: dict[str, tuple[str | None, dict[str, Any]]] = {
            "HOME is nothing": ("", {}),
            "HOME is no folder": ("/dev/null/nobody", {}),
        }
        if os.geteuid() == 0:
            homes["HOME is not set, nor is the user known"] = (None, {"user": NOBODY})
        for said, (home, streams) in homes.items():
            with self.row(said, "plan") as outcomes, self.judged(outcomes, said):
                variables = {"PINOGRASP_CACHE": None, "XDG_CACHE_HOME": None, "HOME": home}
                where = self.fresh()
                where.chmod(0o777)
                self._plans_without(where, "" if home == "" else "cache", variables, **streams)
                outcomes["planned"] += 1

    def _plans_without(self, folder: Path, named: str, environment: Mapping[str, str | None], **streams: Any) -> None:
        done = self._machine.run(folder, *PLAN, environment=environment, **streams).require(0)
        _check_plan(folder, done, None, self._subjects["plan"].whole)
        warned = [line for line in done.errors.splitlines() if "PINOGRASP_CACHE" in line]
        if named and (len(warned) != 1 or named not in warned[0]):
            raise WrongError(f"warnings: {warned}")

    # ---- terminals

    def terminals(self) -> None:
        """Take the terminal away: the files are written whatever becomes of it."""
        ascii_only = {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0", "LC_ALL": "C", "LANG": "C"}
        kinds: dict[str, tuple[dict[str, Any], dict[str, str], tuple[int, ...]]] = {
            "nobody reads the output": ({"stdout": _unread()}, {}, (0,)),
            "nobody reads the errors": ({"stderr": _unread()}, {}, (0,)),
            "nobody reads either": ({"stdout": _unread(), "stderr": _unread()}, {}, (0,)),
            "the output is closed": ({"preexec_fn": lambda: os.close(1)}, {}, (0,)),
            "all streams are closed": ({"preexec_fn": lambda: os.closerange(0, 3)}, {}, (0,)),
            "the output is full": ({"stdout": os.open("/dev/full", os.O_WRONLY)}, {}, (2,)),
            "the errors are full": ({"stderr": os.open("/dev/full", os.O_WRONLY)}, {}, (0,)),
            "an ASCII terminal": ({}, ascii_only, (0,)),
            "a terminal that hangs up": (_terminal(), {}, (0, 129)),
        }
        for kind, (streams, environment, codes) in kinds.items():
            with self.row(kind, "plan") as outcomes, self.judged(outcomes, kind):
                folder = self.fresh()
                hang_up = streams.pop("hang_up", None)
                done = self._machine.run(
                    folder, *PLAN, environment=environment, at=hang_up or (lambda process: None), **streams
                ).require(*codes)
                if done.code != 129:
                    _require_same(folder / "out" / f"{NAME}.json", self._subjects["plan"].whole)
                _require_clean(folder)
                outcomes["files written"] += 1

    # ---- shared

    def shared(self, plans: int = 8) -> None:
        """Begin plans at once on an empty cache, while somebody has its database open for writing."""
        with self.row(f"{plans} plans at once, no cache", "plan") as outcomes:
            cache = self.fresh()
            shutil.copytree(self._machine.cache / "covers", cache / "covers")
            self._at_once(plans, cache, outcomes)
        with self.row("its database is open for writing elsewhere", "plan") as outcomes:
            (file,) = cache.glob("*.duckdb")
            writer = "import duckdb, sys; c = duckdb.connect(sys.argv[1]); print(flush=True); sys.stdin.read()"
            with subprocess.Popen(
                [sys.executable, "-c", writer, file], stdin=subprocess.PIPE, stdout=subprocess.PIPE
            ) as other:
                assert other.stdout is not None
                other.stdout.readline()
                self._at_once(2, cache, outcomes)
                other.kill()
        with self.row("opened for writing while it plans", "plan") as outcomes, self.judged(outcomes, "a writer"):

            def write(process: subprocess.Popen[str]) -> None:
                while process.poll() is None:
                    duckdb.connect(str(file)).close()
                    time.sleep(0.05)

            done = self._machine.run(self.fresh(), *PLAN, at=write, environment={"PINOGRASP_CACHE": str(cache)})
            done.require(0)
            outcomes["neither waits"] += 1

    def _at_once(self, plans: int, cache: Path, outcomes: Counter[str]) -> None:
        from concurrent.futures import ThreadPoolExecutor

        def planned(folder: Path) -> Done:
            return self._machine.run(folder, *PLAN, environment={"PINOGRASP_CACHE": str(cache)})

        folders = [self.fresh() for _ in range(plans)]
        with ThreadPoolExecutor(plans) as threads:
            for folder, done in zip(folders, threads.map(planned, folders), strict=True):
                with self.judged(outcomes, "one of many"):
                    _check_plan(folder, done.require(0), None, self._subjects["plan"].whole)
                    outcomes["the same grasps"] += 1
        built = [json.dumps(str(file.name)) for file in cache.glob("*.duckdb")]
        with self.judged(outcomes, "the cache"):
            _require_clean(cache)
            if len(built) != 1 or list(cache.glob("*.unfinished")):
                raise WrongError(f"databases {built}")


def _sender(number: int, moment: float) -> Callable[[subprocess.Popen[str]], None]:
    """Return what sends a signal after some seconds: SIGINT and SIGHUP to the whole group."""

    def send(process: subprocess.Popen[str]) -> None:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(moment)
        with contextlib.suppress(ProcessLookupError):
            to = os.killpg if number in (signal.SIGINT, signal.SIGHUP) else os.kill
            if process.poll() is None:
                to(process.pid, number)

    return send


def _unread() -> int:
    """Return the end of a pipe that nobody reads."""
    reading, writing = os.pipe()
    os.close(reading)
    return writing


def _terminal() -> dict[str, Any]:
    """Return the arguments of a process in a terminal, which hangs up when it has begun."""
    parent, child = os.openpty()

    def hang_up(process: subprocess.Popen[str]) -> None:
        os.close(child)
        time.sleep(1.0)
        os.close(parent)

    return {"stdin": child, "stdout": child, "stderr": child, "hang_up": hang_up}


@contextlib.contextmanager
def _file_in_the_way(folder: Path) -> Iterator[Path]:
    (folder / "file").write_text("")
    yield folder / "file" / "folder"


@contextlib.contextmanager
def _file_in_place(folder: Path) -> Iterator[Path]:
    (folder / "file").write_text("")
    yield folder / "file"


@contextlib.contextmanager
def _mounted(folder: Path, options: str) -> Iterator[Path]:
    place = folder / "place"
    place.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", place], check=True)
    try:
        yield place
    finally:
        subprocess.run(["umount", place], check=True)


def _may_mount(folder: Path) -> bool:
    try:
        with _mounted(folder, "size=4k"):
            return True
    except (OSError, subprocess.CalledProcessError):
        return False


PARTS = ("signals", "workers", "folders", "terminals", "shared")
COMMANDS = ("plan", "build", "report")


def main(arguments: Sequence[str] | None = None) -> int:
    """Try all parts, print the table, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--moments", type=int, default=50, help="of a signal and a command")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=COMMANDS, help="of signals and workers")
    parser.add_argument("--processes", type=int, default=2, help="workers of a command")
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        folder = Path(name)
        folder.chmod(0o755)
        cache = folder / "cache"
        cache.mkdir()
        faults = Faults(Machine(cache, given.processes), folder, given.moments, given.seed, given.commands)
        faults.prepare()
        for part in given.parts:
            getattr(faults, part)()
    print("| fault | command | times | outcomes | wrong |")
    print("|---|---|---|---|---|")
    print("\n".join(faults.lines))
    return 1 if faults.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
