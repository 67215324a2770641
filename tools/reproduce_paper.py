"""The paper's four cases, planned anew and set beside what the paper prints, as one page.

    python tools/reproduce_paper.py OUT [--robots NAME ...] [--cases NAME ...] [--starts 1304]
        [--compare [STARTS]] [--algorithms [STARTS]] [--alternative] [--sweep [STARTS]] [--fresh]

writes OUT/paper.md and OUT/paper.html (self-contained), with pictures beside them. Every result is kept in OUT/results
as soon as it is there: after Ctrl-C, or with more options, the same command goes on where it was. A result whose
robot file, scene file or options have changed is computed again; after a change of the program `--fresh` computes
everything again (the page says which commit computed what). Times are those of this machine.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pinograsp
from paper.algorithms import algorithms_section
from paper.alternative import alternative_section
from paper.cases import CASES, STARTS
from paper.comparison import comparison_section
from paper.corrections import corrections_section
from paper.figures import grasps_section, sorted_costs_section
from paper.page import Block, write_page
from paper.runs import Results, Session, run_cases
from paper.store import Store
from paper.sweep import sweep_section
from paper.tables import introduction, machine_section, marks_section, printed_tables_section, summary_section

ROBOTS = ("gen3_2f85", "gen3_2f85_paper")
TITLE = "Optimal grasping pose synthesis in a constrained environment: the paper's cases reproduced"


def main(arguments: Sequence[str] | None = None) -> int:
    """Compute what is missing and write the page; return the exit code."""
    options = _options(arguments)
    try:
        session = Session(
            store=Store(options.out / "results", fresh=options.fresh),
            robots=tuple(pinograsp.load_robot(name) for name in options.robots),
            cases=tuple(CASES[name] for name in options.cases),
            starts=options.starts,
            seed=options.seed,
            workers=options.workers,
        )
        results = run_cases(session)
        blocks = introduction(session)
        for section in _sections(options, session, results):
            blocks += section()
            # The page is there after every section: the later ones take long.
            files = write_page(options.out, "paper", TITLE, [*blocks, *machine_section(session)])
    except pinograsp.InputError as error:
        print(f"reproduce_paper: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    print("wrote " + " and ".join(map(str, files)))
    return 0


def _sections(options: argparse.Namespace, session: Session, results: Results) -> list[Callable[[], list[Block]]]:
    pictures: Path = options.out / "pictures"
    sections: list[Callable[[], list[Block]]] = [
        lambda: summary_section(session, results),
        lambda: marks_section(session, results),
        lambda: sorted_costs_section(session, results, pictures),
        lambda: printed_tables_section(session, results),
        lambda: grasps_section(session, results, pictures),
        corrections_section,
    ]
    if options.alternative:
        sections.append(lambda: alternative_section(session, results))
    if options.sweep:
        sections.append(lambda: sweep_section(session, options.sweep, pictures))
    if options.compare:
        sections.append(lambda: comparison_section(session, options.compare))
    if options.algorithms:
        sections.append(lambda: algorithms_section(session, options.algorithms))
    return sections


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("out", type=Path, help="folder to write into")
    add("--robots", nargs="+", default=ROBOTS, metavar="NAME", help="robots, by name or file")
    add("--cases", nargs="+", default=tuple(CASES), choices=tuple(CASES), metavar="NAME", help=", ".join(CASES))
    add("--starts", type=int, default=STARTS, help="starts of each case")
    add("--seed", type=int, default=0)
    add("--workers", type=int, default=os.cpu_count() or 1)
    some: dict[str, Any] = {"nargs": "?", "type": int, "default": 0, "metavar": "STARTS"}
    add("--compare", const=16, help="LD_SLSQP against LN_COBYLA, on 16 starts unless said otherwise", **some)
    add("--algorithms", const=4, help="other algorithms of NLopt, with the first robot, on 4 starts", **some)
    add("--alternative", action="store_true", help="the simple way: hand poses, inverse kinematics, filter")
    add("--sweep", const=40, help="case 2 with other weights of the forces, on 40 starts", **some)
    add("--fresh", action="store_true", help="compute everything again")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
