"""What makes a task work, found by short plans, and each verified by another one: more starts, or the least changes."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ..descriptions import Scene
from ..errors import InputError
from ..progress import Progress, Report
from ..results.explanation import Remedy, Tried
from .relaxations import suitable
from .relaxations.variant import Change, Failure, Variant
from .trials import ENOUGH, SURE, Trials

CLOSE = 0.1
"""Part of a size to which it is found."""
HALF = 0.6
"""Part of a size at which another way must help to be better."""
FURTHER = (1.0, 1.25, 1.6, 2.2)
"""Factors of a size that are tried until the plan verifies it."""
UNCHANGED = 4
"""The scene as it is has this part of the time at most, 1 / 4."""
PLENTY = 3.0
"""Verified starts that a plan is to have by the share of them in another: one then has none in exp(-3), or 5 %."""


def remedies(failure: Failure, trials: Trials, report: Report) -> Iterator[Remedy | Tried]:
    """Yield, for one change after the other, the least size of it that helps, or how far it was tried.

    Every change has its part of the time, and what those before it have left of theirs. Where other starts of the scene
    as it is are verified, that is the only remedy: a change helps there, too, however small, and for no reason.

    Args:
        failure: what is to be mended.
        trials: short plans.
        report: called before every change.
    """
    changes = suitable(failure)
    more = _more_starts(failure, trials) if failure.done else None
    if more is not None:
        yield more
        return
    for number, change in enumerate(changes):
        report(Progress("remedies", number, len(changes)))
        parts = sum(other.share for other in changes[number:]) / change.share
        outcome = _Search(failure.scene, change, trials, parts).outcome()
        if outcome is not None:
            yield outcome


def _more_starts(failure: Failure, trials: Trials) -> Remedy | None:
    """Return the number of starts with which the scene works as it is; None if no other start is verified.

    A plan of few starts says little, so that another one follows. After one of many, a short plan has to find a grasp
    first: it is sooner at its end.
    """
    trials.share(UNCHANGED)
    try:
        if failure.done >= SURE and not trials.helps(failure.scene):
            return None
        verified, tried = trials.sure(failure.scene)
    except TimeoutError:
        return None
    if not verified:
        return None
    starts = max(math.ceil(PLENTY * tried / verified), failure.done)
    return Remedy("starts", f"plan with {starts} starts or more", float(starts), "", {}, verified, tried)


class _Search:
    """The search for the least size of a change.

    Args:
        scene: without the change.
        change: what is tried.
        trials: short plans.
        parts: of the time that is left it has one of so many equal ones.
    """

    def __init__(self, scene: Scene, change: Change, trials: Trials, parts: float) -> None:
        self._scene, self._change, self._trials, self._parts = scene, change, trials, parts
        self._furthest = 0.0
        """Size up to which none helps, as far as is known."""
        self._unsure = False
        """Whether some size helped in a short plan, but not in the one that verifies it."""
        self._made = False
        """Whether there is such a change of some size."""

    def outcome(self) -> Remedy | Tried | None:
        """Return the least change that helps, or how far it was tried; None: there is no such change of the scene."""
        change, whole = self._change, True
        try:
            self._trials.share(self._parts)
            found = None
            if change.without is None or self._trials.helps(change.without):
                found = self._steady() if change.steady else self._growing()
            else:
                self._furthest = change.sizes[-1]
            if found is not None:
                return found
        except TimeoutError:
            whole = False
        if whole and not self._made and change.without is None:
            return None
        text = change.tried(self._furthest or max(change.sizes))
        return Tried(change.kind, text, self._furthest, change.unit, whole, self._unsure)

    def _growing(self) -> Remedy | None:
        """Return the least change of that way which helps first; where another helps at much less, of that one."""
        change = self._change
        for size in change.sizes:
            for variant in change.variants:
                if self._helps(variant, size):
                    found = self._verified(*self._smaller(variant, self._between(variant, 0.0, size)))
                    if found is not None:
                        return found
            self._furthest = max(self._furthest, size)
        return None

    def _smaller(self, variant: Variant, size: float) -> tuple[Variant, float]:
        """Return the way that helps at the least size, so far as the time allows, and that size."""
        try:
            for other in self._change.variants:
                if other is not variant and self._helps(other, HALF * size):
                    variant, size = other, self._between(other, 0.0, HALF * size)
        except TimeoutError:
            pass
        return variant, size

    def _steady(self) -> Remedy | None:
        """Return the least change of the first way that helps at its largest size."""
        for variant in self._change.variants:
            sizes = [size for size in self._change.sizes if self._changed(variant, size) is not None]
            if sizes and self._helps(variant, sizes[-1]):
                found = self._verified(variant, self._between(variant, 0.0, sizes[-1], tuple(sizes)))
                if found is not None:
                    return found
        self._furthest = self._change.sizes[-1]
        return None

    def _between(self, variant: Variant, low: float, high: float, sizes: tuple[float, ...] = ()) -> float:
        """Return the least size that helps, to `CLOSE` of it, between one that does not and one that does.

        First some sizes are looked at, then those between two of them. It is not as near to the least where the share
        of the time is over.
        """
        try:
            while high - low > max(self._change.step, CLOSE * high):
                inside = [size for size in sizes if low < size < high]
                middle = inside[len(inside) // 2] if inside else 0.5 * (low + high)
                low, high = (low, middle) if self._helps(variant, middle) else (middle, high)
        except TimeoutError:
            pass
        return high

    def _helps(self, variant: Variant, size: float) -> bool:
        there = self._changed(variant, size)
        return there is not None and self._trials.helps(there)

    def _verified(self, variant: Variant, size: float) -> Remedy | None:
        """Return the remedy of a size or one a little larger that the longer plan verifies."""
        change = self._change
        self._trials.share(1)  # what is known to help is worth the time of what is not
        for factor in FURTHER:
            larger = change.step * math.ceil(factor * size / change.step - 1e-6)
            there = self._changed(variant, larger)
            if there is None:
                break
            self._unsure = True
            verified, tried = self._trials.sure(there)
            if verified >= ENOUGH:
                amount, text = variant.amount(larger), variant.text(larger)
                return Remedy(change.kind, text, amount, change.unit, variant.changes(larger), verified, tried)
        self._trials.share(self._parts)
        return None

    def _changed(self, variant: Variant, size: float) -> Scene | None:
        """Return the scene with a change; None where there is no such change."""
        try:
            there = Remedy(self._change.kind, "", 0.0, "", variant.changes(size), 0, 0).apply(self._scene)
            self._made = True
            return there
        except (InputError, ValueError):
            return None
