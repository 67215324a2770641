"""The page of proposed contacts: the object among its neighbours, and pairs of points, each in its colour."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np

from ..descriptions import Scene
from ..descriptions.mesh_keys import mesh_keys
from ..disk import as_path, write_whole
from ..errors import InputError, UnknownNameError, close_names, require_kind
from ..problem.contact_pairs import ContactPair
from . import camera, colors
from .forces import ARROW_RADIUS
from .page import legend, page, view_button
from .scene import draw_body, draw_enclosure
from .symbols import Look, arrow, ball, draw, frustum
from .viewer import Recorder, Visualizer, child, clear_backdrop

ROOT = "contacts"
"""Node of the viewer's tree that holds the world."""
POINT_RADIUS = 0.0025
ARROW_LENGTH = 0.02
LINE_RADIUS = 0.0004
AROUND = 1.6
"""Radius of the close-up in radii of what the pairs span."""
SEEN_FROM = np.array([-1.0, -1.0, 0.8])


def write_contacts_html(pairs: Sequence[ContactPair], scene: Scene, object: str, file: Path | str) -> None:
    """Write pairs of contacts as one HTML file: the picture, to turn with the mouse, beside their list.

    An arrow towards each point is how a pad comes to it. The file is complete or not there; an older one is replaced.

    Args:
        pairs: from `contacts`.
        scene: with the object where it stands.
        object: its name.
        file: where to write.

    Raises:
        InputError: there is no pair, no such object, or the file cannot be written.
    """
    require_kind("scene", scene, Scene)
    if not pairs:
        raise InputError("there is no pair to draw", key="pairs")
    if object not in scene.objects:
        remedy = close_names(object, scene.objects)
        raise UnknownNameError(f"no object {object!r} in this scene", file=scene.source, key="object", remedy=remedy)
    recorder = Recorder()
    visualizer = Visualizer(window=recorder)
    with mesh_keys(scene):
        views = _draw(visualizer, pairs, scene, object)
    title = f"{scene.name} / {object}"
    panel = (
        "<h1>Proposed contacts</h1>",
        f"<p>{escape(object)} in {escape(scene.name)}; points in the object's frame, mm</p>",
        view_button("close-up", "Close-up") + view_button("whole-box", "Whole box"),
        f"<table><tr><th></th><th>width</th><th>points</th></tr>{''.join(map(_row, range(len(pairs)), pairs))}</table>",
        legend({"object": colors.OBJECT, "obstacles and other objects": colors.OTHER}),
    )
    write_whole(as_path("file", file), page(title, "\n".join(panel), recorder.commands, views))


def _draw(visualizer: Visualizer, pairs: Sequence[ContactPair], scene: Scene, name: str) -> dict[str, camera.View]:
    """Draw scene and pairs; return the views of the page."""
    world, body = visualizer[ROOT], scene.objects[name]
    draw_enclosure(world["enclosure"], scene.enclosure)
    draw_body(world["object"], body, Look(colors.OBJECT, 0.45, colors.OBJECT_LAYER))
    others = {**scene.obstacles, **{other: thing for other, thing in scene.objects.items() if other != name}}
    for other, thing in others.items():
        draw_body(child(world["obstacles"], other), thing, Look(colors.OTHER))
    T = body.pose.matrix
    for number, pair in enumerate(pairs):
        node, look = world["pairs"][str(number)], Look(colors.of_number(number), layer=colors.SYMBOL_LAYER)
        points, normals = pair.points @ T[:3, :3].T + T[:3, 3], pair.normals @ T[:3, :3].T
        draw(node["line"], frustum(points[0], points[1], LINE_RADIUS, LINE_RADIUS), look)
        for side, (point, normal) in enumerate(zip(points, normals, strict=True)):
            draw(node[f"point {side}"], ball(point, POINT_RADIUS), look)
            for part, piece in arrow(point + ARROW_LENGTH * normal, point, 0.3 * ARROW_RADIUS).items():
                draw(node[f"{part} {side}"], piece, look)
    clear_backdrop(visualizer)
    places = np.concatenate([pair.points for pair in pairs]) @ T[:3, :3].T + T[:3, 3]
    middle = places.mean(axis=0)
    reach = AROUND * float(np.linalg.norm(places - middle, axis=1).max())
    low, high = np.array(scene.enclosure.min), np.array(scene.enclosure.max)
    views = {
        "close-up": camera.around(middle - reach, middle + reach, SEEN_FROM),
        "whole-box": camera.around(low, high, SEEN_FROM),
    }
    camera.place(world, views["close-up"])
    return views


def _row(number: int, pair: ContactPair) -> str:
    points = "; ".join(", ".join(f"{1e3 * x:z.1f}" for x in point) for point in pair.points)
    swatch = f'<span style="color: {colors.css(colors.of_number(number))}">&#9632;</span>'
    return f"<tr><td>{swatch}&nbsp;{number + 1}</td><td>{1e3 * pair.width:.1f}</td><td>{points}</td></tr>"
