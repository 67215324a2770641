"""The world of a scene: of its enclosure alone, and of one of its tasks."""

from __future__ import annotations

from ..descriptions import Scene, Task
from ..descriptions.bodies import Object
from ..descriptions.mesh_keys import mesh_keys
from ..descriptions.task import Margins
from ..geometry.shapes import surface_of
from ..kinematics.robot import Robot
from .allowed_pairs import allowed_pairs
from .solids import link_bodies, scene_body, wall_bodies
from .world import Body, World

MARGIN_EXCESS = 2e-5
"""Kept on top of a task's margins, m: a certificate sees round primitives as facets that stand a bit outside them."""


def enclosure_world(robot: Robot, scene: Scene, margins: Margins) -> World:
    """Return the robot, the walls and the fixed obstacles of a scene; objects are left out.

    Args:
        robot: mounted as the scene says.
        scene: the scene.
        margins: least distances.
    """
    with mesh_keys(scene):
        obstacles = [scene_body("obstacle", name, body) for name, body in scene.obstacles.items()]
    return World(
        bodies=(*link_bodies(robot), *wall_bodies(scene.enclosure), *obstacles),
        margins={"wall": margins.enclosure, "obstacle": margins.enclosure, "link": margins.robot},
        allowed=allowed_pairs(robot, margins.robot),
    )


def task_world(robot: Robot, scene: Scene, task: Task) -> World:
    """Return the robot, the walls, the object of a task, and all that is an obstacle in it: the other objects too.

    Args:
        robot: mounted as the scene says.
        scene: the scene.
        task: one of its tasks.
    """
    obstacles = [scene_body("obstacle", name, body) for name, body in scene.bodies_besides(task).items()]
    target = _target(task.object, scene.objects[task.object])
    around, own, target_margin = (
        m + MARGIN_EXCESS for m in (task.margin.enclosure, task.margin.robot, task.margin.object)
    )
    return World(
        bodies=(*link_bodies(robot), *wall_bodies(scene.enclosure), *obstacles, target),
        margins={"wall": around, "obstacle": around, "target": target_margin, "link": own, "held": own},
        allowed=allowed_pairs(robot, task.margin.robot),
    )


def _target(name: str, body: Object) -> Body:
    """Return the object that is to be grasped; without solids if links are kept off it point by point."""
    if surface_of(body.shape).uneven:
        return Body("target", name, 0, body.pose.matrix, (), ())
    return scene_body("target", name, body)
