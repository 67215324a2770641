"""An assessment: sets of errors drawn and judged, margins found, by as many processes as there are."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from functools import partial
from typing import Any

from ..compiled import compiling
from ..descriptions.mesh_keys import mesh_keys
from ..errors import require_kind, require_report, whole_number
from ..execution import Workers, own_workers
from ..interrupts import heard, taken
from ..progress import Progress, Report, no_report
from ..results import Grasp
from .errors import SAMPLES, Draw, Errors, draws
from .judge import Judge
from .margins import KINDS, margin_of
from .outcome import Assessment, Margin, Sample
from .verdict import Verdict

MOST = 1_000_000


def assess(
    grasp: Grasp,
    errors: Errors | None = None,
    *,
    samples: int = SAMPLES,
    seed: int = 0,
    workers: int | None = None,
    progress: Report = no_report,
) -> Assessment:
    """Judge how much a grasp puts up with: errors of pose, friction, weight, centre of mass and joints.

    In every sample all errors are drawn, the hand closes again on the object where it is, and the independent
    verification says whether pads and nothing else touch it and whether the contacts balance the load at the planned
    squeeze (`judge` has the model and what it leaves out). The margins vary one kind of error and leave the others
    zero (`margins` says what is guaranteed).

    The same seed gives the same numbers for any number of workers. Ctrl-C ends it and returns what is done.

    Args:
        grasp: of a result, which says robot, scene and task.
        errors: their sizes; None: `Errors()`.
        samples: number of sets of errors.
        seed: of the random numbers.
        workers: number of processes; None: one for each core.
        progress: called after every sample and every margin.

    Raises:
        InputError: the grasp belongs to no result, a file of its robot is missing, or a number is out of range.
    """
    require_kind("grasp", grasp, Grasp, remedy="Take one of `Result.grasps`")
    if errors is not None:
        require_kind("errors", errors, Errors, remedy="Give pinograsp.Errors(...)")
    require_report(progress)
    samples, seed = whole_number("samples", samples, 1, MOST), whole_number("seed", seed, 0, None)
    running = own_workers(workers)
    with (
        heard(),
        compiling(progress),
        mesh_keys(grasp.required_setup.scene),
    ):  # all that has to be compiled is, before processes begin
        judge = Judge(grasp)
        sizes = (errors or Errors()).for_task(judge.task.contact.friction)
        drawn = draws(sizes, samples, len(grasp.q_arm), seed)
        planned = judge.verdict(judge.no_errors)
    verdicts, margins = dict[int, Verdict](), dict[str, Margin]()
    kinds = list(KINDS) if planned.holds else []
    interrupted = False
    try:
        with running:
            with heard():
                running.begin()
            for number, verdict in _each(running, partial(_judging, grasp), list(enumerate(drawn))):
                verdicts[number] = verdict
                progress(Progress("samples", len(verdicts), len(drawn)))
            for margin in _each(running, partial(_finding, grasp), kinds, chunk=1):
                margins[margin.kind] = margin
                progress(Progress("margins", len(margins), len(kinds)))
    except KeyboardInterrupt:
        taken()
        interrupted = True
    found = tuple(Sample(number + 1, drawn[number], verdicts[number]) for number in sorted(verdicts))
    in_order = tuple(margins[kind] for kind in KINDS if kind in margins)
    return Assessment(sizes, samples, seed, found, in_order, planned, interrupted)


def _each(workers: Workers, prepare: Callable[[], Callable[[Any], Any]], items: list[Any], chunk: int = 8) -> Any:
    with closing(workers.run(prepare, items, chunk)) as outcomes:
        yield from outcomes


def _judging(grasp: Grasp) -> Callable[[tuple[int, Draw]], tuple[int, Verdict]]:
    """Build, in a worker, the judge of numbered sets of errors."""
    judge = Judge(grasp)
    return lambda item: (item[0], judge.verdict(item[1]))


def _finding(grasp: Grasp) -> Callable[[str], Margin]:
    """Build, in a worker, the search for margins."""
    return partial(margin_of, Judge(grasp))
