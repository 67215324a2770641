"""One grasp in time: settle, a second of gravity, shakes and spins, and the search for the first slip.

The base of the hand stays where it is; its acceleration a is the inertial force -m a on the object, which is a change
of gravity. Its angular acceleration alpha about the object's centre of mass is the torque -I alpha on it (the Euler
force of a body that turns about its centre; centrifugal forces of the speed that builds up are left out).

The object is in place where it has moved and turned less than the limits since it had settled, and before that, since
the start; servos and pads on springs may yield five times as far while it settles. Shakes follow one upon the other;
after one that moved the object out of its place, it is put back to where it had settled.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from .library import mujoco
from .mjcf import LINK, OBJECT, PAD, TIMESTEP, HoldModel
from .options import HoldOptions
from .outcome import FirstSlip

LOOK_STEPS = 5
"""Steps between two looks."""
_RISE, _HELD, _PAUSE = 0.05, 0.2, 0.1
"""Of a shake, s: its acceleration rises, stays, falls as it rose, and is followed by a pause."""
_SETTLE = 0.2
"""After the squeeze has risen, and again after the weight has: s."""
_YIELDING = 5.0
"""How many times the limits the object may move while it settles in a hand of springs."""
_AVERAGED = 0.1
"""At the end of the phase of gravity, over which the forces of the pads are averaged, s."""
DIRECTIONS = {f"{sign:+d}"[0] + axis: sign * np.eye(3)[k] for k, axis in enumerate("xyz") for sign in (1, -1)}
"""Of accelerations, by name: +x, -x, +y, -y, +z, -z of the world."""
_STILL = np.zeros(3)


class Moved(NamedTuple):
    """How far the object is from its place."""

    distance: float
    """m."""
    angle: float
    """rad."""


class Phase(NamedTuple):
    """The object at the end of a phase."""

    name: str
    distance: float
    """From its place, m."""
    angle: float
    """rad."""
    in_place: bool
    touched: tuple[str, ...]
    """Links that touched it other than with a pad; empty if it is out of place."""


class Simulation:
    """The model of a grasp at work.

    Args:
        model: of the grasp.
        options: loads and limits.
        look: called with the simulation every few steps, such as a camera.
    """

    def __init__(
        self, model: HoldModel, options: HoldOptions, look: Callable[[Simulation], None] | None = None
    ) -> None:
        self._library = mujoco()
        self._given, self._options, self._look = model, options, look
        self.model: Any = self._library.MjModel.from_xml_string(model.xml)
        self.data: Any = self._library.MjData(self.model)
        self._object = self.model.body(OBJECT).id
        geoms = [self.model.geom(k).name.split(":", 1) for k in range(self.model.ngeom)]
        self._pads = [name[1] if name[0] == PAD else None for name in geoms]
        self._links = [name[1].rsplit(":", 1)[0] if name[0] == LINK else None for name in geoms]
        self.phase = "settle"
        self.acceleration, self.spin = np.zeros(3), np.zeros(3)
        """Of the base now, m/s^2 and rad/s^2."""
        self._touched: set[str] = set()
        self._library.mj_forward(self.model, self.data)
        self._place = self._pose()
        self._settled: Any = None

    def phases(self) -> Iterator[Phase]:
        """Go through the phases; yield each at its end. Where settle or gravity end out of place, nothing follows."""
        settled = self._settle()
        yield self._ended("settle", *settled, _YIELDING if self._given.yields else 1.0)
        self._place, self._settled = self._pose(), self._state()
        self.phase = "gravity"
        self._run(1.0 - _AVERAGED)
        yield self._ended("gravity", *self.moved())
        still, options = np.zeros(3), self._options
        shakes = [(f"shake {name}", options.acceleration * along, still) for name, along in DIRECTIONS.items()]
        spins = [(f"spin {name}", still, options.spin * about) for name, about in DIRECTIONS.items()]
        for name, acceleration, spin in shakes + spins:
            self.phase = name
            self._shake(acceleration, spin)
            phase = self._ended(name, *self.moved())
            yield phase
            if not phase.in_place:
                self._restore(self._settled)

    def pad_forces(self) -> dict[str, float]:
        """Go on for a moment; return the mean normal force of every pad on the object, N."""
        sums, looks = {pad: 0.0 for pad in self._pads if pad}, _looks(_AVERAGED)
        force = np.zeros(6)
        for _ in range(looks):
            self._load(_STILL, _STILL)
            self._step()
            for k in range(self.data.ncon):
                pad = self._other(k, self._pads)
                if pad:
                    self._library.mj_contactForce(self.model, self.data, k, force)
                    sums[pad] += float(force[0]) / looks
        return sums

    def first_slip(self) -> FirstSlip:
        """Return the least acceleration, over the directions, at which the settled object leaves its place."""
        options = self._options
        least, least_name = math.inf, ""
        touching: set[str] = set()
        for name, direction in DIRECTIONS.items():
            self._restore(self._settled)
            self._touched.clear()
            most = min(least, options.strongest)  # no need to shake harder than where another direction slips
            acceleration, step = 0.0, options.ramp * LOOK_STEPS * TIMESTEP
            while acceleration < most and self._in_place():
                acceleration += step
                self._load(acceleration * direction, _STILL)
                self._step()
                touching |= self._touched if self._in_place() else set()
            if not self._in_place() and acceleration < least:
                least, least_name = acceleration, name
        self._touched.clear()
        slipped = math.isfinite(least)
        return FirstSlip(min(least, options.strongest), least_name, slipped, tuple(sorted(touching)))

    def moved(self) -> Moved:
        """Return how far the object is from its place."""
        position, quaternion = self._pose()
        (place, orientation), w = self._place, quaternion @ self._place[1]
        # Exact for small angles, which arccos is not.
        sine = np.linalg.norm(quaternion - math.copysign(1.0, w) * orientation)
        cosine = np.linalg.norm(quaternion + math.copysign(1.0, w) * orientation)
        return Moved(float(np.linalg.norm(position - place)), 4.0 * math.atan2(sine, cosine))

    def _in_place(self) -> bool:
        return self._within(*self.moved())

    def _within(self, distance: float, angle: float, times: float = 1.0) -> bool:
        return distance < times * self._options.slip_distance and angle < times * self._options.slip_angle

    def _ended(self, name: str, distance: float, angle: float, times: float = 1.0) -> Phase:
        in_place = self._within(distance, angle, times)
        touched = tuple(sorted(self._touched)) if in_place else ()
        self._touched.clear()
        return Phase(name, distance, angle, in_place, touched)

    def _settle(self) -> Moved:
        self.model.opt.gravity[:] = 0.0
        for share in self._rising(_SETTLE / 2):
            self.data.ctrl[:] = self._given.slack * (1.0 - share if self._options.squeeze else 1.0)
            self._step()
        for share in self._rising(_SETTLE / 2):
            self._load(_STILL, _STILL, share)
            self._step()
        self._run(_SETTLE)
        return self.moved()

    def _shake(self, acceleration: Array, spin: Array) -> None:
        shares = [*self._rising(_RISE), *[1.0] * _looks(_HELD)]
        for share in [*shares, *reversed(list(self._rising(_RISE)))]:
            self._load(share * acceleration, share * spin)
            self._step()
        self._load(_STILL, _STILL)
        self._run(_PAUSE)

    def _rising(self, seconds: float) -> Iterator[float]:
        """Yield shares from 0 to 1, without a jump of their slope, for steps that take so long together."""
        count = _looks(seconds)
        yield from (0.5 - 0.5 * math.cos(math.pi * (k + 1) / count) for k in range(count))

    def _run(self, seconds: float) -> None:
        for _ in range(_looks(seconds)):
            self._step()

    def _load(self, acceleration: Array, spin: Array, share: float = 1.0) -> None:
        """Load the object with a share of the task's wrench and with an acceleration of the base."""
        self.acceleration, self.spin = acceleration, spin
        self.model.opt.gravity[:] = share * self._given.gravity - acceleration
        self.data.xfrc_applied[self._object, 3:] = share * self._given.torque - self._given.inertia @ spin

    def _step(self) -> None:
        self._library.mj_step(self.model, self.data, LOOK_STEPS)
        for k in range(self.data.ncon):
            link = self._other(k, self._links)
            if link and self.data.contact.efc_address[k] >= 0:
                self._touched.add(link)
        if self._look:
            self._look(self)

    def _other(self, contact: int, names: list[str | None]) -> str | None:
        first, second = self.data.contact.geom[contact]
        return names[int(first)] or names[int(second)]

    def _pose(self) -> tuple[Array, Array]:
        return self.data.xpos[self._object].copy(), self.data.xquat[self._object].copy()

    def _state(self) -> Any:
        kind = self._library.mjtState.mjSTATE_INTEGRATION
        state = np.zeros(self._library.mj_stateSize(self.model, kind))
        self._library.mj_getState(self.model, self.data, state, kind)
        return state

    def _restore(self, state: Any) -> None:
        self._library.mj_setState(self.model, self.data, state, self._library.mjtState.mjSTATE_INTEGRATION)
        self._library.mj_forward(self.model, self.data)


def _looks(seconds: float) -> int:
    return round(seconds / TIMESTEP / LOOK_STEPS)
