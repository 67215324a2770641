"""Benchmark of the hold test: best, random and worst grasps of each case of the paper, and how true their Q_force is.

    python tools/benchmark_hold.py [case ...] [--robots gen3_2f85 gen3_2f85_paper] [--starts 300] [--count 20]
    python tools/benchmark_hold.py --results out/glovebox_sphere_gen3_2f85.json ...

prints two Markdown tables. The first: of the best, of random and of the worst grasps, the shares that hold at rest,
shaken and turned, how far the pads' forces at rest are from the planned ones, and how many have links that touch
besides pads. The second: how the resistance Q_force of the certificates goes with the acceleration at which the object
first slips, for all grasps and for those that nothing but pads holds until then. Then the marks. Each grasp runs with
two negative controls, no squeeze and next to no friction; the exit code is 1 if one of these holds.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.stats import spearmanr

import pinograsp
from paper.cases import CASES
from pinograsp.hold.options import HoldOptions
from pinograsp.hold.outcome import HoldOutcome
from pinograsp.hold.run import hold_test, in_order
from pinograsp.results import Result

SETS = ("best", "random", "worst")
FORCE, HELD, RANK, LEAST_RATIO, MOST_RATIO, RATIOS = 0.03, 0.95, 0.9, 0.9, 1.2, 0.9
"""Marks: error of pad forces, share of the best that hold, rank correlation, measured / predicted and its share."""
SPREAD = 1.1
"""Least ratio of the 95th to the 5th percentile of Q_force at which a rank correlation means something."""


class Compared(NamedTuple):
    """Figures of the grasps of one case."""

    predicted: np.ndarray
    """Q_force, m/s^2."""
    measured: np.ndarray
    """Acceleration of first slip, m/s^2."""
    pads_only: np.ndarray
    """Whether nothing but pads touched until then."""


@dataclass(frozen=True)
class Tested:
    """Outcomes of one case."""

    name: str
    sets: dict[str, list[HoldOutcome]]

    @property
    def outcomes(self) -> list[HoldOutcome]:
        """All of them, each once."""
        return list({outcome.grasp: outcome for chosen in self.sets.values() for outcome in chosen}.values())

    @property
    def compared(self) -> Compared:
        """The grasps that have both figures."""
        rows = [
            (outcome.predicted, outcome.first_slip.acceleration, not outcome.first_slip.touching)
            for outcome in self.outcomes
            if outcome.predicted is not None and outcome.first_slip is not None and outcome.first_slip.slipped
        ]
        predicted, measured, pads_only = np.array(rows, dtype=np.float64).reshape(-1, 3).T
        return Compared(predicted, measured, pads_only.astype(bool))

    @property
    def spread(self) -> bool:
        """Whether the grasps differ in what they withstand."""
        predicted = self.compared.predicted
        if len(predicted) < 3:
            return False
        low, high = np.percentile(predicted, [5, 95])
        return bool(high > SPREAD * low)


def results(arguments: argparse.Namespace) -> Iterator[tuple[str, Result]]:
    """Yield what is tested, by name."""
    for file in arguments.results:
        result = pinograsp.read_json(file)
        yield f"{result.robot}, {result.scene} {result.task}", result
    for robot in [] if arguments.results else arguments.robots:
        for case in (CASES[name] for name in arguments.cases or CASES):
            scene = pinograsp.load_scene(case.scene)
            model = pinograsp.load_robot(robot)
            yield f"{robot}, {case.title}", pinograsp.plan(model, scene, case.task, starts=arguments.starts, seed=0)


def tested(name: str, result: Result, arguments: argparse.Namespace) -> Tested:
    """Run the hold test of a result."""
    grasps, count = in_order(result), arguments.count
    between = np.random.default_rng(arguments.seed).permutation(len(grasps))[:count]
    numbers = {
        "best": list(range(min(count, len(grasps)))),
        "random": sorted(between.tolist()),
        "worst": list(range(max(0, len(grasps) - count), len(grasps))),
    }
    chosen = sorted({number for some in numbers.values() for number in some})
    options = HoldOptions(first_slip=True, controls=True)
    show = sys.stderr.isatty()

    def say(progress: pinograsp.Progress) -> None:
        if show:
            print(f"\r{name}: {progress.done} of {progress.total}", end="", file=sys.stderr, flush=True)

    found = hold_test([grasps[number] for number in chosen], None, options=options, progress=say)
    by_number = dict(zip(chosen, found, strict=True))
    return Tested(name, {one: [by_number[number] for number in numbers[one]] for one in SETS})


def share(outcomes: Sequence[HoldOutcome], *kinds: str) -> float:
    """Return the share of outcomes that failed in no phase of some kinds."""
    whole = [not any(phase.startswith(kinds) for phase in outcome.failed) for outcome in outcomes]
    return float(np.mean(whole))


AT_REST = ("settle", "gravity")


def at_rest(outcomes: Sequence[HoldOutcome]) -> list[HoldOutcome]:
    """Return the outcomes of grasps that hold at rest: only these have forces to compare."""
    return [outcome for outcome in outcomes if share([outcome], *AT_REST) == 1.0]


def first_table(cases: Sequence[Tested]) -> list[str]:
    """Return the rows about what holds."""
    lines = [
        "| case | grasps | at rest | shaken | turned | all | pad forces, median and largest error | others touch |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for case in cases:
        for one, outcomes in case.sets.items():
            errors = [outcome.force_error for outcome in at_rest(outcomes)] or [math.nan]
            shares = [share(outcomes, *AT_REST, *kinds) for kinds in ((), ("shake",), ("spin",), ("shake", "spin"))]
            touching = sum(bool(outcome.touching) for outcome in outcomes)
            text = " | ".join(f"{100 * value:.0f} %" for value in shares)
            forces = f"{100 * np.median(errors):.2f} %, {100 * max(errors):.2f} %"
            lines.append(f"| {case.name} | {len(outcomes)} {one} | {text} | {forces} | {touching} |")
    return lines


def second_table(cases: Sequence[Tested]) -> list[str]:
    """Return the rows about resistance and first slip."""
    lines = [
        "| case | grasps | Q_force, m/s^2 | first slip, m/s^2 | Spearman (pads only) "
        "| measured / predicted, 5, 50, 95 % | others touch before |",
        "|---|---|---|---|---|---|---|",
    ]
    for case in cases:
        slips = [outcome.first_slip.acceleration for outcome in case.outcomes if outcome.first_slip is not None]
        measured = f"{min(slips):.1f} .. {max(slips):.1f}" if slips else "-"
        predicted, compared, pads_only = case.compared
        row = [case.name, str(len(case.outcomes)), "-", measured, "-", "-", "-"]
        if len(predicted):
            row[2] = f"{predicted.min():.1f} .. {predicted.max():.1f}"
            row[4] = f"{rank(case):.2f} ({rank(case, pads_only):.2f})" if case.spread else "no spread"
            row[6] = str(np.count_nonzero(~pads_only))
            row[5] = ", ".join(f"{value:.2f}" for value in np.percentile(compared / predicted, [5, 50, 95]))
        lines.append(f"| {' | '.join(row)} |")
    return lines


def rank(case: Tested, which: np.ndarray | slice = slice(None)) -> float:
    """Return the rank correlation of what is predicted and measured, of some grasps or all."""
    return float(spearmanr(case.compared.predicted[which], case.compared.measured[which]).statistic)


def marks(cases: Sequence[Tested]) -> Iterator[tuple[str, bool | None]]:
    """Yield what was to be reached, and whether it was; None: nothing to judge by."""
    best = [outcome for case in cases for outcome in case.sets["best"]]
    held = share(best, "")
    yield f"{100 * held:.1f} % of the best hold (at least {100 * HELD:.0f} %)", held >= HELD
    resting = [outcome for case in cases for outcome in at_rest(case.outcomes)]
    largest = max((outcome.force_error for outcome in resting), default=math.nan)
    text = f"pad forces of the {len(resting)} grasps that hold at rest within {100 * largest:.2f} % of the planned ones"
    yield f"{text} (at most {100 * FORCE:.0f} %)", largest <= FORCE
    ranks = [rank(case) for case in cases if case.spread]
    if ranks:
        median = float(np.median(ranks))
        yield f"rank correlation {median:.2f}, median of {len(ranks)} cases (at least {RANK})", median >= RANK
    else:
        yield "rank correlation: no case in which certificates have Q_force and grasps differ in it", None
    ratios = np.concatenate([case.compared.measured / case.compared.predicted for case in cases])
    if len(ratios):
        within = float(np.mean((ratios >= LEAST_RATIO) & (ratios <= MOST_RATIO)))
        text = f"{100 * within:.0f} % of measured / predicted within {LEAST_RATIO} .. {MOST_RATIO}"
        yield f"{text} (at least {100 * RATIOS:.0f} %)", within >= RATIOS
    else:
        yield "measured / predicted: no certificate has Q_force", None


def main() -> None:
    """Test, print, and exit with 1 if a negative control holds."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", help=f"of the paper, all if none is given: {', '.join(CASES)}")
    parser.add_argument("--robots", nargs="+", default=["gen3_2f85", "gen3_2f85_paper"])
    parser.add_argument("--starts", type=int, default=300)
    parser.add_argument("--count", type=int, default=20, help="grasps in each set")
    parser.add_argument("--seed", type=int, default=0, help="of the random set")
    parser.add_argument("--results", nargs="+", type=Path, default=[], help="written results in place of plans")
    arguments = parser.parse_args()
    if unknown := set(arguments.cases) - CASES.keys():
        parser.error(f"there is no case {', '.join(sorted(unknown))}")
    cases = [tested(name, result, arguments) for name, result in results(arguments) if result.grasps]
    print("\n".join([*first_table(cases), "", *second_table(cases), ""]))
    for text, reached in marks(cases):
        print(f"- {text}: {'-' if reached is None else 'reached' if reached else 'MISSED'}")
    outcomes = [outcome for case in cases for outcome in case.outcomes]
    holding = sum(any(outcome.controls.values()) for outcome in outcomes)
    print(f"- negative controls: {holding} of {2 * len(outcomes)} hold: {'FAILED' if holding else 'as they must'}")
    seconds = np.mean([outcome.seconds for outcome in outcomes])
    print(f"- {seconds:.1f} s a grasp on one core, search for the first slip and controls included")
    if holding:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
