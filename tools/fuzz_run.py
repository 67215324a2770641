"""Batches of inputs run by workers, whose progress and failures stay in a folder."""

from __future__ import annotations

import contextlib
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
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import fuzz_sources
from fuzz_judge import OUTCOMES, failure_of, watch
from fuzz_kinds import KINDS, warm
from fuzz_supervisor import BATCH, MEMORY, end_with_parent, supervised
from pinograsp.tables import Table

COMMANDS = 0.02
"""Share of the inputs that a command reads, too."""


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

    Raises:
        KeyboardInterrupt: it was interrupted; no worker is left.
        BrokenProcessPool: a worker was killed.
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
    with tempfile.TemporaryDirectory() as name, prepared(Path(name).resolve() / "sources"):
        with tempfile.TemporaryDirectory() as sound:
            warm(Path(sound))
        began = time.perf_counter()
        pool = ProcessPoolExecutor(workers, multiprocessing.get_context("fork"), _begin, (os.getpid(),))
        try:
            for job in as_completed([pool.submit(_batch, *job, seed, Path(name).resolve(), out) for job in jobs]):
                kind, begin, end, outcomes = job.result()
                found[kind].update(outcomes)
                with progress.open("a") as stream:
                    stream.write(json.dumps({"kind": kind, "begin": begin, "end": end, "outcomes": outcomes}) + "\n")
                total = sum(counts.total() for counts in found.values())
                if every is not None and total >= printed + every:
                    printed = total
                    rate = (total - before) / (time.perf_counter() - began)
                    print(f"{table(found)}\n{total} inputs, {rate:.1f} a second", flush=True)
        except (KeyboardInterrupt, BrokenProcessPool):
            for process in getattr(pool, "_processes", None) or {}:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
            raise
        finally:
            pool.shutdown(cancel_futures=True)
    return found


def _begin(parent: int) -> None:
    """Set up a worker: its parent ends it, whatever the signal that came to all."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    end_with_parent(parent)


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
    shutil.copytree(scratch / "cache", home / "cache", copy_function=os.link)
    os.environ |= {"PINOGRASP_CACHE": str(home / "cache"), "HOME": str(home)}
    outcomes: Counter[str] = Counter()
    for number, outcome in run(kind, seed, range(begin, end), home):
        outcomes[outcome] += 1
        if outcome not in OUTCOMES:
            name = f"{kind}-{seed}-{number}"
            shutil.copytree(home / name, out / name, dirs_exist_ok=True)
            if (log := _log_of(home)).exists():
                shutil.move(log, out / name / "failure.txt")
    shutil.rmtree(home)
    return kind, begin, end, outcomes


def run(kind: str, seed: int, numbers: range, home: Path) -> Iterator[tuple[int, str]]:
    """Yield what comes of inputs of a kind, by number."""
    yield from supervised(lambda some, pipe: _child(kind, seed, some, home, pipe), numbers, _log_of(home))


def _log_of(home: Path) -> Path:
    """Return the file in which a child says what is wrong with itself."""
    return home.parent / f"{home.name}.log"


def _child(kind: str, seed: int, numbers: range, home: Path, pipe: int) -> None:
    """Run a batch of inputs and report each in a line; of a failure its folder stays."""
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    resource.setrlimit(resource.RLIMIT_AS, (32 * MEMORY, 32 * MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    most = _peak() + MEMORY
    tempfile.tempdir = str(home)
    watch(home)
    for number in numbers:
        os.write(pipe, f"{number} begun\n".encode())
        rng, folder = random.Random(f"{seed} {kind} {number}"), home / f"{kind}-{seed}-{number}"
        folder.mkdir()
        os.chdir(folder)
        KINDS[kind].make(folder, rng)
        Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
        outcome, details = failure_of(KINDS[kind], folder, rng.random() < COMMANDS)
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


@contextlib.contextmanager
def prepared(folder: Path) -> Iterator[None]:
    """Make the sources that are not shipped, in a child: this process opens no database and starts no thread.

    The cache folder is beside them in the block.
    """
    environment, parent = dict(os.environ), os.getpid()
    os.environ["PINOGRASP_CACHE"] = str(folder.parent / "cache")
    sys.stdout.flush()
    if (process := os.fork()) == 0:
        try:
            end_with_parent(parent)
            fuzz_sources.prepare(folder)
            os._exit(0)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(1)
    try:
        if os.waitpid(process, 0)[1]:
            raise SystemExit("the sources could not be made")
        fuzz_sources.SOURCES[:] = [str(folder)]
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
