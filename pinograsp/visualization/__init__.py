"""The picture of a grasp: live in meshcat, or as one HTML file that needs neither server nor network.

The arm's visual meshes, the transparent glovebox, the object, contact points, forces and friction cones.
`robot_page` draws a robot file with what a check says of it, `contacts_page` contacts that are proposed,
`coverage` draws which parts of the enclosure a start database reaches.
This is the only package that imports meshcat and matplotlib.
"""

from __future__ import annotations

from pathlib import Path

from ..disk import as_path, write_whole
from ..errors import InputError, require_kind
from ..results.configuration_check import ConfigurationCheck
from ..results.grasp import Grasp
from ..results.ranking import SCORE
from ..results.result import Result
from ..results.setup import Setup
from . import camera
from .approach import draw_approach
from .comparison import clearance_table, grasp_list
from .contacts_page import write_contacts_html
from .coverage import coverage_html, coverage_png
from .forces import draw_forces
from .page import grasp_page
from .robot import draw_robot
from .robot_page import write_robot_html
from .scene import draw_scene
from .viewer import Recorder, Visualizer, clear_backdrop, live

__all__ = ["coverage_html", "coverage_png", "show", "write_contacts_html", "write_html", "write_robot_html"]

ROOT = "pinograsp"
"""Node of the viewer's tree that holds the world."""


def show(grasp: Grasp | Result | ConfigurationCheck, visualizer: Visualizer | None = None) -> Visualizer:
    """Draw a grasp in a meshcat viewer, in place of what was drawn there before.

    Args:
        grasp: a grasp of a result; of a result, the best; a checked configuration, verified or not.
        visualizer: viewer to draw in; without it a server is started, which ends with the process.

    Returns:
        The viewer; `open()` shows it in the browser, `url()` is its address.

    Raises:
        InputError: a mesh cannot be read, a joint of the robot has no angle, the grasp belongs to no result, or the
            result has no grasp.
    """
    grasp, setup = _drawable(grasp)
    visualizer = live() if visualizer is None else visualizer
    _draw(grasp, setup, visualizer)
    return visualizer


def write_html(
    grasp: Grasp | Result | ConfigurationCheck, file: Path | str, caption: str = "", by: str = SCORE
) -> None:
    """Write a grasp as one HTML file: the picture, to turn with the mouse, beside its figures.

    The file is complete or not there; an older one is replaced.

    Args:
        grasp: a grasp of a result; of a result, the best, beside the list of the best that differ from each other;
            a checked configuration, beside its distances, and what refutes it if it is not verified.
        file: where to write.
        caption: text below the heading.
        by: of a result, which is the best, as for `Result.ranked`.

    Raises:
        InputError: as for `show`, there is no such criterion or figure, or the file cannot be written.
    """
    listed = _listed(grasp, by)
    grasp, setup = _drawable(grasp, by)
    recorder = Recorder()
    _draw(grasp, setup, Visualizer(window=recorder))
    write_whole(as_path("file", file), grasp_page(recorder.commands, grasp, setup, caption, listed))


def _listed(grasp: Grasp | Result | ConfigurationCheck, by: str) -> str:
    """Return the table that stands beside the figures of what is drawn."""
    if isinstance(grasp, Result) and grasp.grasps:
        return grasp_list(grasp, by)
    return clearance_table(grasp) if isinstance(grasp, ConfigurationCheck) else ""


def _drawable(grasp: Grasp | Result | ConfigurationCheck, by: str = SCORE) -> tuple[Grasp, Setup]:
    """Return the grasp to draw, and where it belongs."""
    require_kind("grasp", grasp, Grasp, Result, ConfigurationCheck)
    if isinstance(grasp, Result):
        chosen = next(iter(grasp.ranked(by)), None)
        if chosen is None:
            raise InputError("the result has no grasp to draw")
    else:
        chosen = grasp.grasp if isinstance(grasp, ConfigurationCheck) else grasp
    return chosen, chosen.required_setup


def _draw(grasp: Grasp, setup: Setup, visualizer: Visualizer) -> None:
    scene, task = setup.scene, setup.scene.task(setup.task)
    world = visualizer[ROOT]
    world.delete()
    draw_robot(world, setup.robot, grasp.joints, scene.mounting.matrix)
    draw_scene(world, scene, task)
    draw_forces(world, grasp, scene, task)
    if task.approach is not None:
        draw_approach(world["approach"], task.approach, scene.objects[task.object])
    clear_backdrop(visualizer)
    camera.place(world, camera.whole_box(scene, task))
