"""Colours (0xrrggbb) of the picture, their legend, and what is painted over what."""

from __future__ import annotations

import colorsys

FORCE = 0xD62728
WRENCH = 0x1F4FD8
CONE = 0x2CA02C
DESIRED = 0x2F7BFF
CONTACT = 0x111111
OBJECT = 0xF2A33A
OTHER = 0x9AA0A6
ALLOWED = 0x4CB963
FORBIDDEN = 0xD9534F
APPROACH = 0x8E5BD0
PAD = 0x17A2B8
NORMAL = 0xD62728
OFFENDER = 0xE5383B
WALL = 0x9DB8D2
FLOOR = 0xD5DBE2
EDGE = 0x7C8A99

GLASS_LAYER, OBJECT_LAYER, CONE_LAYER, SYMBOL_LAYER = 0, 1, 2, 3
"""Later layers are painted over earlier ones, see `symbols.Look`."""

LEGEND = {
    "contact force on the object": FORCE,
    "external force at the centre of mass": WRENCH,
    "friction cone": CONE,
    "desired contact point": DESIRED,
    "contact point": CONTACT,
    "object": OBJECT,
    "obstacles and other objects": OTHER,
}

REGION_LEGEND = {"contact allowed": ALLOWED, "contact forbidden": FORBIDDEN}
"""Instead of the object's colour where a task has contact regions."""

PAD_LEGEND = {"pad": PAD, "its outward normal": NORMAL, "wrist's z axis, the approach direction": APPROACH}


def legend(*, regions: bool, approach: bool, desired: bool = True, verified: bool = True) -> dict[str, int]:
    """Return what each colour means, in a task with or without contact regions, approach cone and desired contacts.

    In the picture of a posture that is not verified, what offends has a colour of its own.
    """
    entries: dict[str, int] = {}
    for text, color in LEGEND.items():
        if color == DESIRED and not desired:
            continue
        entries |= REGION_LEGEND if regions and text == "object" else {text: color}
    entries |= {"cone of approach directions": APPROACH} if approach else {}
    return entries | ({} if verified else {"too near to each other, or in each other": OFFENDER})


def of_number(number: int) -> int:
    """Return the colour of one of many: hues a golden section apart, so that neighbours in a list differ."""
    r, g, b = (round(255 * part) for part in colorsys.hsv_to_rgb(0.618034 * number % 1.0, 0.85, 0.8))
    return r << 16 | g << 8 | b


def css(color: int) -> str:
    """Return a colour as CSS writes it."""
    return f"#{color:06x}"
