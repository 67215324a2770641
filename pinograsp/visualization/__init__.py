"""The picture of a grasp: live in meshcat, or as one HTML file that needs neither server nor network.

The arm's visual meshes, the transparent glovebox, the object, contact points, forces and friction cones.
`robot_page` draws a robot file with what a check says of it, `contacts_page` contacts that are proposed,
`coverage` draws which parts of the enclosure a start database reaches.
This is the only package that imports meshcat and matplotlib.
"""

from __future__ import annotations

from pathlib import Path

from ..descriptions.mesh_keys import mesh_keys
from ..disk import as_path, write_whole
from ..errors import InputError, require_kind
from ..results.configuration_check import ConfigurationCheck
from ..results.explanation import Explanation
from ..results.grasp import Grasp
from ..results.ranking import SCORE
from ..results.result import Result
from ..results.setup import Setup
from . import camera
from .approach import draw_approach
from .comparison import clearance_table, explanation_tables, grasp_list
from .contacts_page import write_contacts_html
from .coverage import coverage_html, coverage_png
from .forces import draw_forces
from .offenders import offenders
from .page import grasp_page
from .robot import draw_robot
from .robot_page import write_robot_html
from .scene import draw_scene
from .viewer import Recorder, Visualizer, clear_backdrop, live

__all__ = ["coverage_html", "coverage_png", "show", "write_contacts_html", "write_html", "write_robot_html"]

Shown = Grasp | Result | ConfigurationCheck | Explanation
"""What can be drawn."""

ROOT = "pinograsp"
"""Node of the viewer's tree that holds the world."""


def show(grasp: Shown, visualizer: Visualizer | None = None) -> Visualizer:
    """Draw a grasp in a meshcat viewer, in place of what was drawn there before.

    Args:
        grasp: a grasp of a result; of a result, the best, or the nearest miss if there is none, as of an explanation; a
            checked configuration, verified or not. What offends is red.
        visualizer: viewer to draw in; without it a server is started, which ends with the process.

    Returns:
        The viewer; `open()` shows it in the browser, `url()` is its address.

    Raises:
        InputError: a mesh cannot be read, a joint of the robot has no angle, the grasp belongs to no result, or there
            is neither a grasp nor a nearest miss.
    """
    grasp, setup = _drawable(grasp)
    visualizer = live() if visualizer is None else visualizer
    _draw(grasp, setup, visualizer)
    return visualizer


def write_html(grasp: Shown, file: Path | str, caption: str = "", by: str = SCORE) -> None:
    """Write a grasp as one HTML file: the picture, to turn with the mouse, beside its figures.

    The file is complete or not there; an older one is replaced.

    Args:
        grasp: a grasp of a result; of a result, the best, beside the list of the best that differ from each other;
            without any, and of an explanation, the nearest miss beside the causes; a checked configuration, beside its
            distances. What refutes a posture that is not verified stands above, and is red.
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


def _listed(grasp: Shown, by: str) -> str:
    """Return the table that stands beside the figures of what is drawn."""
    if isinstance(grasp, Result) and grasp.grasps:
        return grasp_list(grasp, by)
    explained = grasp.explanation if isinstance(grasp, Result) else grasp
    if isinstance(explained, Explanation):
        return explanation_tables(explained)
    return clearance_table(grasp) if isinstance(grasp, ConfigurationCheck) else ""


def _drawable(grasp: Shown, by: str = SCORE) -> tuple[Grasp, Setup]:
    """Return the grasp to draw, and where it belongs."""
    require_kind("grasp", grasp, Grasp, Result, ConfigurationCheck, Explanation)
    chosen: Grasp | None
    match grasp:
        case Result():
            explained = grasp.explanation
            chosen = next(iter(grasp.ranked(by)), None if explained is None else explained.nearest_miss)
        case ConfigurationCheck():
            chosen = grasp.grasp
        case Explanation():
            chosen = grasp.nearest_miss
        case _:
            chosen = grasp
    if chosen is None:
        raise InputError("there is no grasp to draw, and no nearest miss")
    return chosen, chosen.required_setup


def _draw(grasp: Grasp, setup: Setup, visualizer: Visualizer) -> None:
    scene, task = setup.scene, setup.scene.task(setup.task)
    world = visualizer[ROOT]
    world.delete()
    marked = offenders(grasp.certificate)
    draw_robot(world, setup.robot, grasp.joints, scene.mounting.matrix, marked)
    with mesh_keys(scene):
        draw_scene(world, scene, task, marked)
        draw_forces(world, grasp, scene, task)
        if task.approach is not None:
            draw_approach(world["approach"], task.approach, scene.objects[task.object])
    clear_backdrop(visualizer)
    camera.place(world, camera.whole_box(scene, task))
