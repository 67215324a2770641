"""Caps and triangles of truncated cones, cylinders among them."""

from __future__ import annotations

import math

import numpy as np
import trimesh

from ..contact_faces import Flat
from ..tessellation import Tessellation, tessellation_of

SECTIONS = 48
"""Sides of the solid that stands for a round one in a tessellation, and of the polygon around a cap."""
MOST_RINGS, CAP_RINGS = 24, 4
"""Rings of its side at most, and of each cap: slender triangles would fall into a great many small ones."""


def cap(radius: float, height: float) -> Flat:
    """Return a disc across the z axis as a polygon around it, its outward normal away from the origin.

    Args:
        radius: of the disc, m.
        height: z of the disc, m, not zero.
    """
    outward = math.copysign(1.0, height)
    angles = outward * (np.arange(SECTIONS) + 0.5) * 2.0 * math.pi / SECTIONS
    around = radius / math.cos(math.pi / SECTIONS)
    rim = [around * np.cos(angles), around * np.sin(angles), np.full(SECTIONS, height)]
    return Flat(np.column_stack(rim), np.array([0.0, 0.0, outward]), radius)


def revolved(bottom: float, top: float, half: float) -> Tessellation:
    """Return the triangles of a truncated cone, in rings about as high as its sides are wide.

    Args:
        bottom: radius at z = -half, m; 0 for a tip.
        top: radius at z = half, m; 0 for a tip.
        half: half the height, m.
    """
    width = 2.0 * max(bottom, top) * math.sin(math.pi / SECTIONS)
    rings = min(math.ceil(math.hypot(2.0 * half, bottom - top) / width), MOST_RINGS)
    ends = [np.linspace(0.0, radius, CAP_RINGS, endpoint=False) if radius else np.array([]) for radius in (bottom, top)]
    side = zip(np.linspace(bottom, top, rings + 1), np.linspace(-half, half, rings + 1), strict=True)
    profile = [*((r, -half) for r in ends[0]), *side, *((r, half) for r in ends[1][::-1])]
    unit = 2.0 ** math.frexp(width)[1]  # trimesh drops triangles that are small in metres; a power of 2 rounds nothing
    made = tessellation_of(trimesh.creation.revolve(np.array(profile) / unit, sections=SECTIONS))
    return made._replace(vertices=unit * made.vertices)
