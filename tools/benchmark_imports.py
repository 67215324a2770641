"""CPU time of what reads and does not plan, against that of importing NumPy and pydantic.

    python tools/benchmark_imports.py [RESULT.json]

Every job is a fresh interpreter; user and system time count, the least of several runs, base and jobs in turns. The
package is compiled to bytecode first, as an installed one is. Without a file a plan of a few starts writes one.
"""

from __future__ import annotations

import argparse
import compileall
import os
import sys
import tempfile
from pathlib import Path

import pinograsp

BASE = ["-c", "import numpy, pydantic"]


def jobs(file: Path) -> dict[str, list[str]]:
    """Return the arguments of the interpreter for every job."""
    read = f"import pinograsp; r = pinograsp.read_json({str(file)!r}); r.best, r.ranked('Q'), r.best.certificate"
    return {
        "import numpy, pydantic": BASE,
        "import pinograsp": ["-c", "import pinograsp"],
        "a name of the descriptions": ["-c", "import pinograsp; pinograsp.Scene"],
        "a name of the results": ["-c", "import pinograsp; pinograsp.Result"],
        "load_scene": ["-c", "import pinograsp; pinograsp.load_scene('glovebox')"],
        "read_json, best, ranked": ["-c", read],
        "pinograsp --help": ["-m", "pinograsp", "--help"],
        "pinograsp plan --help": ["-m", "pinograsp", "plan", "--help"],
        "pinograsp, no such scene": ["-m", "pinograsp", "plan", "nowhere.yaml", "--task", "none"],
        "pinograsp rank FILE": ["-m", "pinograsp", "rank", str(file)],
        "pinograsp show FILE": ["-m", "pinograsp", "show", str(file)],
        "pinograsp list": ["-m", "pinograsp", "list"],
    }


def cpu_seconds(arguments: list[str], silent: int) -> float:
    """Return user and system time of one run of the interpreter."""
    redirected = [(os.POSIX_SPAWN_DUP2, silent, stream) for stream in (1, 2)]
    process = os.posix_spawn(sys.executable, [sys.executable, *arguments], dict(os.environ), file_actions=redirected)
    usage = os.wait4(process, 0)[2]
    return usage.ru_utime + usage.ru_stime


def planned(folder: Path, grasps: int = 10) -> Path:
    """Return a result file with a number of grasps, from as many starts as it takes."""
    robot, scene = pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox")
    starts = 3 * grasps
    result = pinograsp.plan(robot, scene, "sphere", starts=starts)
    while len(result.grasps) < grasps:
        starts *= 2
        result = pinograsp.plan(robot, scene, "sphere", starts=starts)
    file = folder / "result.json"
    pinograsp.write_json(result, file)
    return file


def main() -> None:
    """Measure all jobs in turns and print them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", nargs="?", type=Path, help="result to read")
    parser.add_argument("--runs", type=int, default=9)
    given = parser.parse_args()
    compileall.compile_dir(Path(pinograsp.__file__).parent, quiet=1)
    with tempfile.TemporaryDirectory() as folder, Path(os.devnull).open("w") as silent:
        every = jobs(given.file or planned(Path(folder)))
        best = dict.fromkeys(every, float("inf"))
        for _ in range(given.runs):
            for name, arguments in every.items():
                best[name] = min(best[name], cpu_seconds(arguments, silent.fileno()))
    base = best["import numpy, pydantic"]
    for name, seconds in best.items():
        print(f"{name:28} {1e3 * seconds:6.0f} ms {seconds / base:6.2f}")


if __name__ == "__main__":
    main()
