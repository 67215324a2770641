"""Damaged and hostile files of every kind, read in processes whose time and memory are limited.

    python tools/fuzz.py [--inputs 200000] [--seed 0] [--kind scene ...] [--out out/fuzz] [--workers 2] [--every 5000]
    python tools/fuzz.py --again out/fuzz/scene-0-17 ... [--minimise]

Each input is made from its kind, the seed and its number alone (`fuzz_kinds`). It may be refused by a `PinograspError`
or be used; a failure is a traceback, a command that ends otherwise than with one line of error, a signal, more than
20 s of the processor, more than 1 GB, a file outside its folder, or a number that is not finite where nothing says so.
Failures stay in the folder `--out`, each with the input and what happened. A run that was interrupted goes on with the
same command; remove the folder to begin anew after a change of the code.
"""

from __future__ import annotations

import argparse
import signal
import sys
import tempfile
import time
from pathlib import Path

from fuzz_again import again, minimised
from fuzz_judge import OUTCOMES
from fuzz_kinds import KINDS, warm
from fuzz_run import fuzz, table


def main() -> None:
    """Print the table, or what comes of a saved input; exit with 1 if anything failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--inputs", type=int, default=2000, help="number of all inputs together")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kind", action="append", choices=KINDS, help="only this kind; may be given several times")
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"), help="folder of the failures")
    parser.add_argument("--workers", type=int, default=1, help="processes at once")
    parser.add_argument("--every", type=int, default=5000, help="inputs after which the table is printed")
    parser.add_argument("--again", type=Path, nargs="+", metavar="FOLDER", help="run saved inputs instead")
    parser.add_argument("--minimise", action="store_true", help="make the largest file of each saved input smaller")
    options = parser.parse_args()
    if options.again is not None:
        _run_again([folder.resolve() for folder in options.again], options.minimise)
        return
    signal.signal(signal.SIGINT, _interrupt)  # in the background of a shell it would be ignored
    signal.signal(signal.SIGTERM, _interrupt)
    began, kinds = time.perf_counter(), options.kind or list(KINDS)
    try:
        found = fuzz(kinds, options.inputs, options.seed, options.out.resolve(), options.workers, options.every)
    except KeyboardInterrupt as came:
        print("interrupted; the same command goes on", file=sys.stderr)
        sys.exit(128 + came.args[0])
    total = sum(counts.total() for counts in found.values())
    print(table(found))
    print(f"{total} inputs, {total / (time.perf_counter() - began):.1f} a second")
    sys.exit(any(outcome not in OUTCOMES for counts in found.values() for outcome in counts))


def _interrupt(number: int, frame: object) -> None:
    raise KeyboardInterrupt(number)


def _run_again(folders: list[Path], minimise: bool) -> None:
    with tempfile.TemporaryDirectory() as sound:
        warm(Path(sound))
    for folder in folders:
        if minimise:
            inputs = [file for file in folder.iterdir() if file.is_file() and file.name != "failure.txt"]
            minimised(folder, max(inputs, key=lambda file: file.stat().st_size))
        with tempfile.TemporaryDirectory() as name:
            print(f"{folder.name}: {again(folder, Path(name))}")


if __name__ == "__main__":
    main()
