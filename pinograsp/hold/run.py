"""The hold test of many grasps, over processes."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

from ..errors import require_kind, require_report, whole_number
from ..execution import Workers, own_workers
from ..interrupts import heard, taken
from ..progress import Progress, Report, no_report
from ..results import Grasp, Result, Setup
from ..verification.resistance import Q_FORCE
from .library import mujoco
from .mjcf import HandAndObject
from .options import HoldOptions, given_options
from .outcome import FirstSlip, HoldOutcome, PadForce
from .simulation import Phase, Simulation

CONTROLS: dict[str, dict[str, Any]] = {"no squeeze": {"squeeze": False}, "no friction": {"friction": 0.05}}
"""Negative controls, by what they change."""

Numbered = tuple[int, Grasp]


def hold_test(
    grasps: Result | Grasp | Sequence[Grasp],
    best: int | None = 20,
    *,
    workers: int | None = None,
    options: HoldOptions | None = None,
    progress: Report = no_report,
) -> tuple[HoldOutcome, ...]:
    """Simulate grasps in MuJoCo: whether they hold the object at rest, shaken and turned.

    The hand is fixed where the arm holds it and squeezes as planned; see `mjcf` and `simulation` for the model. The
    same grasps give the same outcomes for any number of workers. Ctrl-C returns the outcomes that are there.

    Args:
        grasps: a result, its grasps in their order, or grasps of results.
        best: how many of them, from the first on; None: all.
        workers: number of processes; None: one for each core.
        options: loads, limits and control.
        progress: called after every grasp, with how many of them are `held`.

    Returns:
        An outcome for each grasp, in their order.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        InputError: a number is out of range, a grasp does not know its setup, a file of the robot is missing, the
            object has a shape that the hold test does not know, or neither mass nor weight.
    """
    if best is not None:
        whole_number("best", best, 1)
    require_report(progress)
    options, processes = given_options(options), own_workers(workers)
    with heard():
        mujoco()
    numbered = list(enumerate(in_order(grasps)[:best], 1))
    outcomes: list[HoldOutcome] = []
    try:
        with processes as running:
            for outcome in _outcomes(running, numbered, options):
                outcomes.append(outcome)
                held = sum(done.held for done in outcomes)
                progress(Progress("grasps", len(outcomes), len(numbered), {"held": held}))
    except KeyboardInterrupt:
        taken()
    return tuple(sorted(outcomes, key=lambda outcome: outcome.grasp))


def in_order(grasps: Result | Grasp | Sequence[Grasp]) -> tuple[Grasp, ...]:
    """Return the grasps of a result, the best first; or what is given."""
    if isinstance(grasps, Grasp):
        return (grasps,)
    if isinstance(grasps, Result):
        return grasps.grasps
    require_kind("grasps", grasps, Result, Grasp, Sequence)
    for grasp in grasps:
        require_kind("grasps", grasp, Grasp)
    return tuple(grasps)


def _outcomes(workers: Workers, numbered: Sequence[Numbered], options: HoldOptions) -> Iterator[HoldOutcome]:
    """Yield outcomes in any order; grasps of one setup that follow each other are sent together."""
    for _, group in itertools.groupby(numbered, key=lambda item: id(item[1].required_setup)):
        items = list(group)
        prepare = partial(HoldTest, items[0][1].required_setup, options)
        bare = [(number, replace(grasp, setup=None)) for number, grasp in items]
        with closing(workers.run(prepare, bare, chunk=1)) as running:
            yield from running


class HoldTest:
    """Tests one grasp after the other, of one robot at one task."""

    def __init__(self, setup: Setup, options: HoldOptions) -> None:
        self._setup, self._options = setup, options
        self._bodies = HandAndObject(setup, options)

    def __call__(self, item: Numbered) -> HoldOutcome:
        """Return the outcome of a grasp and its number."""
        number, grasp = item
        began = time.perf_counter()
        simulation = Simulation(self._bodies.model(grasp), self._options)
        phases, forces, slip = _through(simulation, self._options)
        after = [phase for phase in phases if phase.name != "settle"]
        failed = tuple(phase.name for phase in phases if not phase.in_place)
        planned = {contact.pad: -float(contact.force @ contact.normal) for contact in grasp.contacts}
        return HoldOutcome(
            grasp=number,
            start=grasp.start,
            held=not failed,
            failed=failed,
            distance=max((phase.distance for phase in after), default=phases[0].distance),
            angle=max((phase.angle for phase in after), default=phases[0].angle),
            sag=phases[0].distance,
            standoff=self._bodies.standoff(grasp),
            pads=tuple(PadForce(pad, force, forces.get(pad, 0.0)) for pad, force in planned.items()),
            touching=tuple(sorted({link for phase in phases for link in phase.touched})),
            first_slip=slip,
            predicted=grasp.certificate[Q_FORCE].value if Q_FORCE in grasp.certificate else None,
            controls=self._controlled(grasp) if self._options.controls else {},
            seconds=time.perf_counter() - began,
        )

    def _controlled(self, grasp: Grasp) -> dict[str, bool]:
        return {name: _holds_at_rest(*control, grasp) for name, control in self._control_bodies.items()}

    @cached_property
    def _control_bodies(self) -> dict[str, tuple[HandAndObject, HoldOptions]]:
        changed = {name: replace(self._options, **change) for name, change in CONTROLS.items()}
        return {name: (HandAndObject(self._setup, options), options) for name, options in changed.items()}


def _through(simulation: Simulation, options: HoldOptions) -> tuple[list[Phase], dict[str, float], FirstSlip | None]:
    """Return the phases, the forces of the pads at rest and the first slip."""
    phases: list[Phase] = []
    forces: dict[str, float] = {}
    for phase in simulation.phases():
        phases.append(phase)
        if phase.name in ("settle", "gravity") and not phase.in_place:
            return phases, forces, None
        if phase.name == "gravity":
            forces = simulation.pad_forces()
    return phases, forces, simulation.first_slip() if options.first_slip else None


def _holds_at_rest(bodies: HandAndObject, options: HoldOptions, grasp: Grasp) -> bool:
    phases = itertools.islice(Simulation(bodies.model(grasp), options).phases(), 2)
    return all(phase.in_place for phase in phases)
