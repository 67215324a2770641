"""Units in which tables and pages show figures; inside, everything is SI and radians."""

from __future__ import annotations

import math

SHOWN_IN = {
    "m": (1e3, "mm"),
    "N m": (1e3, "N mm"),
    "rad": (math.degrees(1.0), "°"),
    "m/s^2": (1.0, "m/s²"),
    "m^3": (1.0, "m³"),
}
"""Scale and name of the unit in which a figure is shown; units that are not here stay."""


def shown_in(unit: str) -> tuple[float, str]:
    """Return scale and name of the unit in which figures of a unit are shown."""
    return SHOWN_IN.get(unit, (1.0, unit))
