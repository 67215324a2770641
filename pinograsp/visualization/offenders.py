"""What keeps a posture from being a grasp, by name: links, walls and bodies that are too near to each other."""

from __future__ import annotations

from ..verification.certificate import Certificate

BETWEEN = " / "
"""Between the two bodies that a figure of a certificate is about; others are about pads and joints."""


def offenders(certificate: Certificate) -> frozenset[str]:
    """Return the names of the bodies that the figures which do not hold are about, in pairs."""
    pairs = (figure.where.split(BETWEEN) for figure in certificate.refuted_by)
    return frozenset(name for pair in pairs if len(pair) > 1 for name in pair)
