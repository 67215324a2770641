"""Faces that no other one is opposite to as the pads of a hand are: how much of a surface, and which limit it is."""

from __future__ import annotations

import math

import numpy as np

from ..geometry.antipodal import Pairs
from ..units import shown

LEAST = 0.1
"""Share of the surface from which on it is said."""


class LoneFaces:
    """Counts points that were drawn on a surface by what keeps opposite points from being a pair.

    Args:
        lean: greatest angle between a normal and the line between the points, the friction angle, rad.
        tilt: greatest angle between a normal and the opposite of the other one; None: pads can turn to any, rad.
    """

    def __init__(self, lean: float, tilt: float | None) -> None:
        self._lean, self._tilt = lean, math.inf if tilt is None else tilt
        self._points, self._tilted, self._leaning = 0, list[float](), list[float]()

    def see(self, pairs: Pairs) -> None:
        """Count the first points of pairs, of which one point has up to two."""
        tilts, leans = pairs.tilts, pairs.leans.max(axis=1)
        _, point = np.unique(pairs.points[:, 0], axis=0, return_inverse=True)
        point = point.reshape(-1)
        count = int(point.max(initial=-1)) + 1
        least_tilts, least_leans, fits = np.full(count, np.inf), np.full(count, np.inf), np.zeros(count, dtype=bool)
        np.minimum.at(least_tilts, point, tilts)
        parallel = tilts <= self._tilt
        np.minimum.at(least_leans, point[parallel], leans[parallel])
        np.logical_or.at(fits, point, parallel & (leans <= self._lean))
        self._points += count
        self._tilted += least_tilts[np.isinf(least_leans)].tolist()
        self._leaning += least_leans[~fits & np.isfinite(least_leans)].tolist()

    def remarks(self, friction: float) -> tuple[str, ...]:
        """Return what is to be said of them.

        Args:
            friction: coefficient, to which the friction angle belongs.
        """
        said = []
        if self._are_many(self._tilted):
            turned, within = shown(min(self._tilted), "rad"), shown(self._tilt, "rad")
            why = f"what is opposite is turned by {turned} or more, and the pads stay parallel, within {within}"
            said.append(f"{self._share(self._tilted)}: {why}")
        if self._are_many(self._leaning):
            leans, held = shown(max(self._leaning), "rad"), shown(self._lean, "rad")
            why = f"the line to what is opposite leans by up to {leans}, and friction {friction:.3g} holds {held}"
            said.append(f"{self._share(self._leaning)}: {why}")
        return tuple(said)

    def _are_many(self, angles: list[float]) -> bool:
        return len(angles) > LEAST * self._points

    def _share(self, angles: list[float]) -> str:
        return f"{100.0 * len(angles) / self._points:.0f} % of the surface has no pair"
