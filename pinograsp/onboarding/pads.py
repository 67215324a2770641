"""Findings about single pads: do they lie on their links, do their normals point outwards."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping

import numpy as np

from ..arrays import Array
from ..descriptions.hand import PadDescription
from ..geometry.patches import patch_point
from ..geometry.triangle_mesh import TriangleMesh
from ..kinematics.robot import Robot
from .findings import Finding

OFF = 0.001
"""A pad may be this far off the surface of its link, m."""
PROBE = 0.0015
"""Points this far on both sides of a pad tell which side is inside the link, m."""
STEPS = 7


def pad_findings(robot: Robot, meshes: Mapping[str, TriangleMesh]) -> Iterator[Finding]:
    """Compare every pad with the collision geometry of its link."""
    for pad in robot.description.pads:
        if pad.link not in meshes:
            remedy = "Give the link a <collision>"
            yield Finding("doubtful", f"pad {pad.name}: link {pad.link} has no collision geometry", remedy)
        else:
            yield from _compared(pad, meshes[pad.link])


def _compared(pad: PadDescription, mesh: TriangleMesh) -> Iterator[Finding]:
    points, normals = surface_points(pad)
    off = mesh.surface.distances(points)
    name, remedy = f"pad {pad.name}", f"Check origin, normal, u and v in the frame of {pad.link}; look at the picture"
    if off.min() > OFF:
        what = f"{name} lies outside its link: {1e3 * off.min():.1f} mm off {pad.link} at the nearest"
        yield Finding("wrong", what, remedy)
        return
    above = mesh.surrounds(points + PROBE * normals).mean()
    below = mesh.surrounds(points - PROBE * normals).mean()
    if above > 0.5 > below:
        yield Finding("wrong", f"{name}: the normal points into {pad.link}", "Turn the normal round")
    elif off.max() > OFF:
        what = f"{name}: parts of it are {1e3 * off.max():.1f} mm off the surface of {pad.link}"
        yield Finding("doubtful", what, remedy)
    else:
        yield Finding("ok", f"{name} lies on {pad.link}, at most {1e3 * off.max():.2f} mm off")


def surface_points(pad: PadDescription) -> tuple[Array, Array]:
    """Return points spread over a pad and the outward normals there, link frame, shapes (n, 3)."""
    patch = pad.patch
    grid = itertools.product(*(np.linspace(*interval, STEPS) for interval in patch.parameters))
    places = [patch_point(patch, np.array(parameters)) for parameters in grid]
    points = np.array([place.point for place in places]) @ patch.rotation.T + patch.origin
    return points, np.array([place.normal for place in places]) @ patch.rotation.T
