"""The cone of approach directions that a task wants: where the hand may come from."""

from __future__ import annotations

import numpy as np
import trimesh

from ..arrays import Array
from ..descriptions.bodies import Object
from ..descriptions.task import ApproachCone
from ..geometry.filled import center_of_mass_world
from . import colors
from .symbols import Look, Piece, between, draw
from .viewer import Visualizer, geometry

LENGTH = 0.15
"""Distance of the cone's cap from the object's centre of mass, m."""
STEPS = 24
"""Pieces of the cap from the axis to the border; there are three times as many around."""


def draw_approach(node: Visualizer, approach: ApproachCone, target: Object) -> None:
    """Draw the cone with its apex at the object's centre of mass; it opens against the direction, towards the hand."""
    R = target.pose.matrix[:3, :3] if approach.frame == "object" else np.eye(3)
    toward = R @ np.array(approach.direction)
    piece = cone(center_of_mass_world(target), -toward, approach.angle)
    draw(node, piece, Look(colors.APPROACH, 0.2, colors.CONE_LAYER))


def cone(apex: Array, axis: Array, angle: float) -> Piece:
    """Return the part of a ball around `apex` that is within `angle` (rad, up to pi) of the unit vector `axis`."""
    polar = np.linspace(angle, 0.0, STEPS)
    outline = LENGTH * np.column_stack([np.sin(polar), np.cos(polar)])
    mesh = trimesh.creation.revolve(np.vstack([np.zeros(2), outline]), sections=3 * STEPS)
    # Revolved about z; `between` turns y to the axis.
    vertices = mesh.vertices[:, [1, 2, 0]]
    T = between(apex, apex + axis)
    T[:3, 3] = apex
    return Piece(geometry.TriangularMeshGeometry(vertices, mesh.faces), T)
