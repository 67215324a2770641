"""Pads of a robot file as they lie on the links: the surface, and an arrow along the outward normal."""

from __future__ import annotations

import itertools

import numpy as np

from ..arrays import Array, Integers
from ..descriptions.patches import LinePatch, Patch
from ..geometry.patches import patch_point
from . import colors
from .symbols import Look, arrow, draw
from .viewer import Visualizer, geometry

STEPS = 12
"""Parts into which each side of a patch is divided."""
LIFT = 6e-4
"""How far the drawn surface stands off the patch, so that the link does not show through it, m."""
HALF_LINE = 5e-4
"""Half the drawn width of a line, m."""
ARROW_LENGTH, ARROW_RADIUS = 0.03, 0.001


def draw_pad(node: Visualizer, patch: Patch, color: int = colors.PAD) -> None:
    """Draw a patch in its own frame (x, y, outward normal) at a node of the viewer's tree.

    Args:
        node: the node.
        patch: what to draw.
        color: of its surface, 0xrrggbb.
    """
    vertices, faces = surface(patch)
    material = geometry.MeshPhongMaterial(color=color)
    node["surface"].set_object(geometry.TriangularMeshGeometry(vertices, faces), material)
    middle = patch_point(patch, np.mean(patch.parameters, axis=1))
    tip = middle.point + ARROW_LENGTH * middle.normal
    for name, piece in arrow(middle.point, tip, ARROW_RADIUS).items():
        draw(node[name], piece, Look(colors.NORMAL))


def surface(patch: Patch) -> tuple[Array, Integers]:
    """Return vertices, m, shape (n, 3), and triangles, shape (m, 3), of a patch in its frame."""
    first = np.linspace(*patch.parameters[0], STEPS + 1)
    if isinstance(patch, LinePatch):
        second = np.array([-HALF_LINE, HALF_LINE])
        vertices = np.array([[u, y, LIFT] for u, y in itertools.product(first, second)])
    else:
        second = np.linspace(*patch.parameters[1], STEPS + 1)
        places = (patch_point(patch, np.array(uv)) for uv in itertools.product(first, second))
        vertices = np.array([place.point + LIFT * place.normal for place in places])
    corner = np.arange(len(vertices)).reshape(len(first), len(second))
    a, b, c, d = (part.ravel() for part in (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]))
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return vertices, faces
