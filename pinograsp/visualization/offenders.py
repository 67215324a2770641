"""What keeps a posture from being a grasp, by name: links, walls and bodies that are too near to each other."""

from __future__ import annotations

from ..verification.certificate import Certificate

BETWEEN = " - "
"""Between two bodies of a figure."""


def offenders(certificate: Certificate) -> frozenset[str]:
    """Return the names of what the figures that do not hold are about: pairs of bodies, pads, joints."""
    return frozenset(name for figure in certificate.refuted_by for name in figure.where.split(BETWEEN) if name)
