"""Flat faces as the pads of a robot file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .facets import Facet
from .yaml_text import text

INSET = 0.001
"""Of a pad from the edges of its face, so that a contact never sits on the rim, m."""
HARD = "{model: hard_finger}"
SOFT = "{model: soft_finger, torsion_radius: 0.002, torsional_stiffness: 0.05}    # CHECK: a guess, of rubber"


def pad_lines(facet: Facet, name: str, contact: str) -> list[str]:
    """Return the lines of a pad in the list of a robot file.

    Args:
        facet: where it lies.
        name: of the pad.
        contact: its contact model, YAML.
    """
    half = facet.sides / 2 - INSET
    return [
        f"  - name: {text(name)}",
        f"    link: {text(facet.link)}",
        "    patch:",
        "      type: plane",
        f"      origin: {numbers(facet.origin, 7)}",
        f"      normal: {numbers(facet.axes[:, 2], 9)}",
        f"      x_axis: {numbers(facet.axes[:, 0], 9)}",
        f"      u: {numbers([-half[0], half[0]], 5)}",
        f"      v: {numbers([-half[1], half[1]], 5)}",
        f"    contact: {contact}",
    ]


def pad_names(links: Sequence[str]) -> list[str]:
    """Return `left` and `right` where the links are called so, else the links' names."""
    sides = ["left" if "left" in link.lower() else "right" if "right" in link.lower() else link for link in links]
    return sides if len(set(sides)) == len(sides) else list(links)


def numbers(values: Iterable[float], digits: int) -> str:
    """Write numbers as a YAML list, without exponents, which YAML takes for text."""
    return "[" + ", ".join(number(value, digits) for value in values) + "]"


def number(value: float, digits: int = 9) -> str:
    """Write a number in the same way."""
    short = f"{round(float(value), digits) + 0.0:.{digits}f}".rstrip("0")  # adding 0 makes -0.0 plain
    return f"{short}0" if short.endswith(".") else short
