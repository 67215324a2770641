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

IN_SI = {"mm": (1e-3, "m"), "deg": (math.radians(1.0), "rad")}
"""Scale and SI unit of the units in which constraints report violations; units that are not here stay."""


def in_si(value: float, unit: str) -> tuple[float, str]:
    """Return a value and its unit in SI and radians."""
    scale, si = IN_SI.get(unit, (1.0, unit))
    return scale * value, si


def shown(value: float, unit: str, form: str = ".3g") -> str:
    """Return a value with the unit in which it is shown, such as "31.2 mm".

    A length that is infinite, as a distance or as what is lacking of one, is that of bodies that intersect to an
    unknown depth.
    """
    if unit == "m" and math.isinf(value):
        return "overlap"
    scale, name = shown_in(unit)
    number = format(scale * value, form)
    number = f"{float(number):g}" if "e+" in number else number  # 1000, not 1e+03
    return f"{number} {name}".rstrip()


def shown_in(unit: str) -> tuple[float, str]:
    """Return scale and name of the unit in which figures of a unit are shown."""
    return SHOWN_IN.get(unit, (1.0, unit))
