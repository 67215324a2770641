"""The picture of a grasp: live in meshcat, or as one HTML file that needs neither server nor network.

The arm's visual meshes, the transparent glovebox, the object, contact points, forces and friction cones.
`coverage` draws which parts of the enclosure a start database reaches.
This is the only package that imports meshcat and matplotlib.
"""

from __future__ import annotations

from pathlib import Path

from ..descriptions import RobotDescription, SceneDescription
from ..disk import write_whole
from ..results.grasp import Grasp
from . import camera
from .approach import draw_approach
from .coverage import coverage_html, coverage_png
from .forces import draw_forces
from .page import grasp_page
from .robot import draw_robot
from .scene import draw_scene
from .viewer import Recorder, Visualizer, live

__all__ = ["coverage_html", "coverage_png", "show", "write_html"]

ROOT = "pinograsp"
"""Node of the viewer's tree that holds the world."""


def show(
    grasp: Grasp,
    robot: RobotDescription,
    scene: SceneDescription,
    task_name: str,
    visualizer: Visualizer | None = None,
) -> Visualizer:
    """Draw a grasp in a meshcat viewer, in place of what was drawn there before.

    Args:
        grasp: the grasp.
        robot: the robot file that it was found with.
        scene: the scene file that it was found with.
        task_name: the task in the scene.
        visualizer: viewer to draw in; without it a server is started, which ends with the process.

    Returns:
        The viewer; `open()` shows it in the browser, `url()` is its address.

    Raises:
        InputError: no such task, a mesh cannot be read, or a joint of the robot has no angle.
    """
    task = scene.task(task_name)
    visualizer = live() if visualizer is None else visualizer
    world = visualizer[ROOT]
    world.delete()
    draw_robot(world, robot, grasp.joints, scene.mounting.matrix)
    draw_scene(world, scene, task)
    draw_forces(world, grasp, scene, task)
    if task.approach is not None:
        draw_approach(world["approach"], task.approach, scene.objects[task.object])
    for name in ("/Grid", "/Axes"):
        visualizer[name].set_property("visible", False)
    visualizer["/Background"].set_property("top_color", [1.0, 1.0, 1.0])
    visualizer["/Background"].set_property("bottom_color", [0.93, 0.94, 0.96])
    camera.place(world, camera.whole_box(scene, task))
    return visualizer


def write_html(
    grasp: Grasp,
    robot: RobotDescription,
    scene: SceneDescription,
    task_name: str,
    file: Path,
    caption: str = "",
) -> None:
    """Write a grasp as one HTML file: the picture, to turn with the mouse, beside its figures.

    The file is complete or not there; an older one is replaced.

    Args:
        grasp: the grasp.
        robot: the robot file that it was found with.
        scene: the scene file that it was found with.
        task_name: the task in the scene.
        file: where to write.
        caption: text below the figures.

    Raises:
        InputError: as for `show`, or the file cannot be written.
    """
    recorder = Recorder()
    show(grasp, robot, scene, task_name, Visualizer(window=recorder))
    write_whole(file, grasp_page(recorder.commands, grasp, robot, scene, task_name, caption))
