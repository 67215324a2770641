"""The glovebox, the obstacles and the objects."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ..descriptions import Scene, Task
from ..descriptions.bodies import Body
from ..descriptions.enclosure import Enclosure
from ..descriptions.regions import Region
from ..geometry.shapes import surface_of
from . import colors
from .regions import painted_surface
from .surfaces import surface_mesh
from .symbols import Look, Piece, box, box_edges, draw
from .viewer import LayeredMesh, Visualizer, child, geometry

WALL_THICKNESS = 0.004
EDGE_RADIUS = 0.003


def draw_scene(viewer: Visualizer, scene: Scene, task: Task, marked: Collection[str] = ()) -> None:
    """Draw the enclosure, the task's object and everything to keep clear of below nodes of these names.

    Args:
        viewer: node of the viewer that holds the world.
        scene: the scene.
        task: the task.
        marked: walls, obstacles and other objects that offend.
    """
    draw_enclosure(viewer["enclosure"], scene.enclosure, marked)
    _draw_object(viewer["object"], scene.objects[task.object], scene.region_of(task))
    for name, body in scene.bodies_besides(task).items():
        look = Look(colors.OFFENDER if name in marked else colors.OTHER)
        draw_body(child(viewer["obstacles"], name), body, look)


def _draw_object(node: Visualizer, body: Body, region: Region | None) -> None:
    """Draw the object, painted by where contact may be if that is not everywhere."""
    if region is None:
        draw_body(node, body, Look(colors.OBJECT, 0.45, colors.OBJECT_LAYER))
        return
    material = geometry.MeshPhongMaterial(vertexColors=True, transparent=True, opacity=0.6, depthWrite=False)
    node.set_object(LayeredMesh(painted_surface(body.shape, region), material, colors.OBJECT_LAYER))
    node.set_transform(body.pose.matrix)


def draw_body(node: Visualizer, body: Body, look: Look) -> None:
    """Draw a shape at its pose."""
    surface = surface_of(body.shape)
    draw(node, Piece(surface_mesh(surface, surface.tessellation()), body.pose.matrix), look)


def draw_enclosure(node: Visualizer, enclosure: Enclosure, marked: Collection[str] = ()) -> None:
    """Draw six thin walls, outside of the room, and their edges; floor and offenders are the least transparent."""
    names = iter(enclosure.walls)
    low, high = np.array(enclosure.min), np.array(enclosure.max)
    glass = Look(colors.WALL, 0.10, colors.GLASS_LAYER)
    floor = Look(colors.FLOOR, 0.65, colors.GLASS_LAYER)
    for axis, letter in enumerate("xyz"):
        for side, outside in (("min", -WALL_THICKNESS), ("max", WALL_THICKNESS)):
            corners = [low.copy(), high.copy()]
            face = corners[0 if side == "min" else 1][axis]
            corners[0][axis], corners[1][axis] = sorted((face, face + outside))
            is_floor = letter == "z" and side == "min"
            look = Look(colors.OFFENDER, 0.35, colors.GLASS_LAYER) if next(names) in marked else None
            draw(node[f"wall_{letter}_{side}"], box(*corners), look or (floor if is_floor else glass))
    for name, piece in box_edges(low, high, EDGE_RADIUS).items():
        draw(node["edges"][name], piece, Look(colors.EDGE, 0.55, colors.GLASS_LAYER))
