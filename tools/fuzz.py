"""Damaged and hostile files of every kind, read in processes whose time and memory are limited.

    python tools/fuzz.py [--inputs 200000] [--seed 0] [--kind scene ...] [--out out/fuzz] [--workers 2] [--every 5000]
    python tools/fuzz.py --again out/fuzz/scene-0-17 [--minimise]

Each input is made from its kind, the seed and its number alone (`fuzz_kinds`). It may be refused by a `PinograspError`
or be used; a failure is a traceback, a command that ends otherwise than with one line of error, a signal, more than
20 s, more than 1 GB, a file outside its folder, or a number that is not finite where nothing says so. Failures stay in
the folder `--out`, each with the input and what happened. A run that was interrupted goes on with the same command;
remove the folder to begin anew after a change of the code.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import multiprocessing
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import fuzz_kinds
import fuzz_sources
from fuzz_kinds import KINDS
from fuzz_supervisor import BATCH, MEMORY, supervised
from pinograsp import PinograspError, cli
from pinograsp.tables import Table

COMMANDS = 0.03
"""Share of the inputs that a command reads, too."""
_WRITES = {"open", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.symlink", "os.link", "os.truncate"}
_TO_WRITE = os.O_WRONLY | os.O_RDWR | os.O_CREAT
OUTCOMES = ("used", "refused")


def failure_of(kind: str, folder: Path, command: bool) -> tuple[str, str]:
    """Return what comes of an input, `used`, `refused` or the name of a failure, and its details."""
    outside.clear()
    try:
        KINDS[kind].use(folder)
        outcome = "used"
    except PinograspError as error:
        outcome = "refused"
        if "\n" in str(error):
            return "error of several lines", str(error)
    except MemoryError:
        return "memory", traceback.format_exc()
    except Exception as error:
        return type(error).__name__, traceback.format_exc()
    if command and (arguments := KINDS[kind].command) is not None:
        code, errors = _commanded(arguments(folder))
        lines = [line for line in errors.splitlines() if line.startswith("error: ")]
        if code not in {0, 1, 2} or len(lines) > 1 or "Traceback" in errors:
            return "command", f"exit code {code}\n{errors}"
    if outside:
        return "file outside", "\n".join(outside)
    return outcome, ""


def _commanded(arguments: list[str]) -> tuple[int, str]:
    """Return exit code and standard error of a command in this process."""
    output, errors = io.StringIO(), io.StringIO()
    given, sys.argv = sys.argv, ["pinograsp", *arguments]
    try:
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            cli.main()
        return 0, errors.getvalue()
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else int(ended.code is not None), errors.getvalue()
    except Exception:
        return -1, traceback.format_exc()
    finally:
        sys.argv = given


outside: list[str] = []
"""What was written outside of the folder since the input began."""


def _watched(home: Path) -> None:
    """Notice whatever Python writes outside of a folder, from now on."""

    def look(event: str, arguments: tuple[Any, ...]) -> None:
        if event not in _WRITES or not arguments or not isinstance(arguments[0], str | bytes | os.PathLike):
            return
        if event == "open" and not (isinstance(arguments[2], int) and arguments[2] & _TO_WRITE):
            return
        path = os.path.realpath(os.fsdecode(arguments[0]))
        if "__pycache__" in path:  # what Numba and Python keep
            return
        if not path.startswith((f"{home}/", "/dev/", "/proc/")) and path != str(home):
            outside.append(f"{event} {path}")

    sys.addaudithook(look)


def _child(kind: str, seed: int, numbers: range, home: Path, pipe: int) -> None:
    """Run a batch of inputs and report each in a line; of a failure its folder stays."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    resource.setrlimit(resource.RLIMIT_AS, (32 * MEMORY, 32 * MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    most = _peak() + MEMORY
    tempfile.tempdir = str(home)
    _watched(home)
    for number in numbers:
        os.write(pipe, f"{number} begun\n".encode())
        rng, folder = random.Random(f"{seed} {kind} {number}"), home / f"{kind}-{seed}-{number}"
        folder.mkdir()
        os.chdir(folder)
        KINDS[kind].make(folder, rng)
        Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
        outcome, details = failure_of(kind, folder, rng.random() < COMMANDS)
        if (peak := _peak()) > most:
            outcome, details = "memory", f"{peak - most + MEMORY} bytes"
        if outcome in OUTCOMES:
            shutil.rmtree(folder)
        else:
            (folder / "failure.txt").write_text(details)
        os.write(pipe, f"{number} {outcome}\n".encode())


def _peak() -> int:
    """Return the most memory that this process had, bytes."""
    (line,) = (line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])


def run(kind: str, seed: int, numbers: range, home: Path) -> Iterator[tuple[int, str]]:
    """Yield what comes of inputs of a kind, by number."""
    yield from supervised(
        lambda some, pipe: _child(kind, seed, some, home, pipe), numbers, home.parent / f"{home.name}.log"
    )


def fuzz(
    kinds: list[str], inputs: int, seed: int, out: Path, workers: int = 1, every: int | None = None
) -> dict[str, Counter[str]]:
    """Run inputs of the kinds, each in its share, and return how many ended in which way.

    Failures, and the progress, stay in a folder: batches that are done there are not run again.

    Args:
        kinds: names of kinds.
        inputs: number of all of them together.
        seed: of all inputs.
        out: folder of the failures.
        workers: processes at once.
        every: number of inputs after which the table is printed.
    """
    out.mkdir(parents=True, exist_ok=True)
    progress = out / f"progress-{seed}.jsonl"
    found: dict[str, Counter[str]] = {kind: Counter() for kind in kinds}
    done = set()
    for line in progress.read_text().splitlines() if progress.exists() else ():
        batch = json.loads(line)
        if batch["kind"] in found:
            done.add((batch["kind"], batch["begin"], batch["end"]))
            found[batch["kind"]].update(batch["outcomes"])
    jobs = [job for job in batches(kinds, inputs) if job not in done]
    printed = before = sum(counts.total() for counts in found.values())
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as name, prepared(Path(name).resolve() / "sources"):
        with tempfile.TemporaryDirectory() as sound:
            fuzz_kinds.warm(Path(sound))
        with ProcessPoolExecutor(workers, multiprocessing.get_context("fork")) as pool:
            waiting = [pool.submit(_batch, *job, seed, Path(name).resolve(), out) for job in jobs]
            try:
                for job in as_completed(waiting):
                    kind, begin, end, outcomes = job.result()
                    found[kind].update(outcomes)
                    with progress.open("a") as stream:
                        line = {"kind": kind, "begin": begin, "end": end, "outcomes": outcomes}
                        stream.write(json.dumps(line) + "\n")
                    total = sum(counts.total() for counts in found.values())
                    if every is not None and total >= printed + every:
                        printed = total
                        rate = (total - before) / (time.perf_counter() - began)
                        print(f"{table(found)}\n{total} inputs, {rate:.1f} a second", flush=True)
            except KeyboardInterrupt:
                print("interrupted; the same command goes on", file=sys.stderr)
                pool.shutdown(wait=False, cancel_futures=True)
                for process in getattr(pool, "_processes", {}).values():
                    process.kill()
    return found


def batches(kinds: list[str], inputs: int) -> list[tuple[str, int, int]]:
    """Return kind, first number and end of the batches, those of all kinds in turn."""
    shares = sum(KINDS[kind].share for kind in kinds)
    made = []
    for kind in kinds:
        count = -(-inputs * KINDS[kind].share // shares)
        made += [(begin / count, kind, begin, min(begin + BATCH, count)) for begin in range(0, count, BATCH)]
    return [job[1:] for job in sorted(made)]


def _batch(kind: str, begin: int, end: int, seed: int, scratch: Path, out: Path) -> tuple[str, int, int, Counter[str]]:
    """Run a batch in a folder of its own, which is this process's home."""
    home = scratch / f"home-{kind}-{begin}"
    home.mkdir()
    os.environ |= {"PINOGRASP_CACHE": str(home / "cache"), "HOME": str(home)}
    outcomes: Counter[str] = Counter()
    for number, outcome in run(kind, seed, range(begin, end), home):
        outcomes[outcome] += 1
        if outcome not in OUTCOMES:
            name = f"{kind}-{seed}-{number}"
            shutil.copytree(home / name, out / name, dirs_exist_ok=True)
    shutil.rmtree(home)
    return kind, begin, end, outcomes


@contextlib.contextmanager
def prepared(folder: Path) -> Iterator[None]:
    """Make the sources that are not shipped, in a child: this process opens no database and starts no thread."""
    environment = dict(os.environ)
    if (process := os.fork()) == 0:
        os.environ["PINOGRASP_CACHE"] = str(folder.parent / "cache")
        try:
            fuzz_sources.prepare(folder)
            os._exit(0)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(1)
    if os.waitpid(process, 0)[1]:
        raise SystemExit("the sources could not be made")
    fuzz_sources.SOURCES[:] = [str(folder)]
    try:
        yield
    finally:
        os.environ.clear()
        os.environ |= environment


def table(found: dict[str, Counter[str]]) -> str:
    """Return the outcomes by kind as text."""
    failures = sorted({outcome for counts in found.values() for outcome in counts} - set(OUTCOMES))
    shown = Table("Inputs by kind and outcome")
    shown.words("kind")
    shown.numbers("inputs", *OUTCOMES, *failures)
    for kind, counts in found.items():
        shown.add(kind, *map(str, (counts.total(), *(counts[outcome] for outcome in (*OUTCOMES, *failures)))))
    return shown.drawn(100)


def again(folder: Path, scratch: Path) -> str:
    """Return the name of what comes of the files of a saved input, in a child of limited time and memory."""

    def work(numbers: range, pipe: int) -> None:
        copied = Path(shutil.copytree(folder, scratch / "input", dirs_exist_ok=True))
        os.write(pipe, b"0 begun\n")
        outcome, details = failure_of(folder.name.split("-")[0], copied, True)
        said = details.splitlines()[-1:] if outcome not in OUTCOMES else []
        os.write(pipe, f"0 {' '.join([outcome, *said])}\n".encode())

    ((_, outcome),) = supervised(work, range(1), scratch / "log")
    shutil.rmtree(scratch / "input")
    return outcome


def minimised(folder: Path, file: Path) -> None:
    """Leave out lines of a file, or bytes, as long as the input fails in the same way."""
    with tempfile.TemporaryDirectory() as name:
        wanted = again(folder, Path(name))
        parts = file.read_bytes().splitlines(keepends=True)
        if len(parts) < 2:
            parts = [bytes([byte]) for byte in b"".join(parts)]
        size = len(parts) // 2
        while size:
            for begin in range(0, len(parts), size):
                fewer = [*parts[:begin], *parts[begin + size :]]
                file.write_bytes(b"".join(fewer))
                if again(folder, Path(name)) == wanted:
                    parts = fewer
                    break
            else:
                size //= 2
        file.write_bytes(b"".join(parts))


def main() -> None:
    """Print the table, or what comes of a saved input; exit with 1 if anything failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--inputs", type=int, default=2000, help="number of all inputs together")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kind", action="append", choices=KINDS, help="only this kind; may be given several times")
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"), help="folder of the failures")
    parser.add_argument("--workers", type=int, default=1, help="processes at once")
    parser.add_argument("--every", type=int, default=5000, help="inputs after which the table is printed")
    parser.add_argument("--again", type=Path, metavar="FOLDER", help="run a saved input instead")
    parser.add_argument("--minimise", action="store_true", help="make the largest file of the saved input smaller")
    options = parser.parse_args()
    if options.again is not None:
        folder = options.again.resolve()
        with tempfile.TemporaryDirectory() as sound:
            fuzz_kinds.warm(Path(sound))
        if options.minimise:
            inputs = [file for file in folder.iterdir() if file.is_file() and file.name != "failure.txt"]
            minimised(folder, max(inputs, key=lambda file: file.stat().st_mtime_ns))
        with tempfile.TemporaryDirectory() as name:
            print(again(folder, Path(name)))
        return
    began = time.perf_counter()
    found = fuzz(
        options.kind or list(KINDS), options.inputs, options.seed, options.out.resolve(), options.workers, options.every
    )
    total = sum(counts.total() for counts in found.values())
    print(table(found))
    print(f"{total} inputs, {total / (time.perf_counter() - began):.1f} a second")
    sys.exit(any(outcome not in OUTCOMES for counts in found.values() for outcome in counts))


if __name__ == "__main__":
    main()
