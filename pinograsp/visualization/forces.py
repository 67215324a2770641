"""Contact points, contact forces, friction cones and the external force of a grasp."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..descriptions import Scene, Task
from ..geometry.filled import center_of_mass_world
from ..results.grasp import Contact, Grasp
from . import colors
from .symbols import Look, arrow, ball, draw, friction_cone
from .viewer import Visualizer, child

LONGEST_ARROW = 0.12
"""Length of the arrow of the greatest force, m."""
ARROW_RADIUS = 0.0035
CONE_HEIGHT = 0.03
CONTACT_RADIUS = 0.003
DESIRED_RADIUS = 0.005


def draw_forces(viewer: Visualizer, grasp: Grasp, scene: Scene, task: Task) -> None:
    """Draw what acts on the object below the nodes `contacts` and `wrench`; one scale for all arrows."""
    weight = np.array(scene.wrench_of(task).force)
    scale = arrow_scale([weight, *(contact.force for contact in grasp.contacts)])
    for contact in grasp.contacts:
        draw_contact(child(viewer["contacts"], contact.pad), contact, task.contact.friction, scale)
    center = center_of_mass_world(scene.objects[task.object])
    draw_arrow(viewer["wrench"], center, center + scale * weight, colors.WRENCH)


def arrow_scale(forces: list[Array]) -> float:
    """Return the m per N at which the greatest of the forces, shapes (3,), is `LONGEST_ARROW` long."""
    greatest = max(float(np.linalg.norm(force)) for force in forces)
    return LONGEST_ARROW / greatest if greatest > 0 else 0.0


def draw_contact(node: Visualizer, contact: Contact, mu: float, scale: float) -> None:
    """Draw one contact: the force pushes from outside, its point at the contact; the cone opens inwards."""
    if contact.desired_point is not None:
        desired = ball(contact.desired_point, DESIRED_RADIUS)
        draw(node["desired"], desired, Look(colors.DESIRED, 0.6, colors.SYMBOL_LAYER))
    draw(node["point"], ball(contact.point, CONTACT_RADIUS), Look(colors.CONTACT, layer=colors.SYMBOL_LAYER))
    cone = friction_cone(contact.point, -contact.normal, mu, CONE_HEIGHT)
    draw(node["cone"], cone, Look(colors.CONE, 0.4, colors.CONE_LAYER))
    draw_arrow(node["force"], contact.point - scale * contact.force, contact.point, colors.FORCE)


def draw_arrow(node: Visualizer, tail: Array, tip: Array, color: int) -> None:
    """Draw an arrow from `tail` to `tip`, shapes (3,), unless it is shorter than 1 mm."""
    if np.linalg.norm(tip - tail) < 1e-3:
        return
    for name, piece in arrow(tail, tip, ARROW_RADIUS).items():
        draw(node[name], piece, Look(color, layer=colors.SYMBOL_LAYER))
