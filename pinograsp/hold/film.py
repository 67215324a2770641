"""A film of a hold test, drawn off screen."""

from __future__ import annotations

import importlib
import io
import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..disk import as_path, write_whole
from ..errors import InputError, require_kind, require_report
from ..progress import Progress, Report, no_report
from ..results import Grasp
from .library import mujoco, pillow
from .mjcf import OBJECT, TIMESTEP, HandAndObject
from .options import HoldOptions, given_options
from .simulation import DIRECTIONS, LOOK_STEPS, Simulation

_SIZE = (640, 480)
_DISTANCE = 0.5
"""Of the camera from the object, m."""
_ALONG = 0.4
"""How much it looks along the hand."""
_RED, _BLUE = (200, 20, 30), (20, 50, 200)
_RATE = 20.0
"""Frames a second."""
_BACKENDS = ("egl", "osmesa", "glfw", "cgl")
"""MuJoCo's ways to draw, in the order in which they are tried: without a screen first."""


def write_film(
    grasp: Grasp, file: Path | str, options: HoldOptions | None = None, *, progress: Report = no_report
) -> None:
    """Write an animated GIF of a grasp that settles, is shaken and turned.

    The base of the hand stays where it is: what moves is the object against the hand. A red arrow shows the
    acceleration of the base, a blue one the axis about which it is turned.

    Args:
        grasp: of a result.
        file: to be written, ending in .gif.
        options: loads and control.
        progress: called before the film and after every phase of it.

    Raises:
        MissingExtraError: MuJoCo or Pillow is not installed.
        InputError: as `hold_test`, the file's name does not end in .gif, it cannot be written, or nothing can draw on
            this machine.
    """
    file, options = film_file(file), given_options(options)
    require_kind("grasp", grasp, Grasp)
    require_report(progress)
    model = HandAndObject(grasp.required_setup, options).model(grasp, shown=True)
    camera = _Camera(across=grasp.contacts[0].normal)
    simulation = Simulation(model, options, look=camera.look)
    total = 2 + 2 * len(DIRECTIONS)  # settle, gravity; shakes and spins
    progress(Progress("film", 0, total))
    try:
        for done, phase in enumerate(simulation.phases(), 1):
            progress(Progress("film", done, total))
            if phase.name in ("settle", "gravity") and not phase.in_place:
                break
    finally:
        camera.close()
    write_whole(file, camera.film())


def film_file(file: Path | str) -> Path:
    """Return where a film is to be written.

    Raises:
        InputError: the name does not end in .gif.
    """
    file = as_path("file", file)
    if file.suffix.lower() != ".gif":
        raise InputError("a film is a GIF", file=file, remedy="Give a name that ends in .gif")
    return file


class _Camera:
    """Takes a frame now and then.

    Args:
        across: direction in the world that should lie across the picture, shape (3,).
    """

    def __init__(self, across: Array) -> None:
        self._pillow = pillow()
        self._library, self._context = mujoco(), _context()
        self._across = across
        self._drawing: tuple[Any, Any] | None = None
        self._frames: list[Any] = []
        self._looks = 0

    def look(self, simulation: Simulation) -> None:
        """Take a frame if it is time."""
        if self._looks % round(1.0 / _RATE / TIMESTEP / LOOK_STEPS) == 0:
            self._frames.append(self._frame(simulation))
        self._looks += 1

    def close(self) -> None:
        """Free the renderer."""
        if self._drawing is not None:
            self._drawing[1].free()
        self._context.free()

    def film(self) -> bytes:
        """Return the frames as a GIF."""
        stream = io.BytesIO()
        first, *others = self._frames
        first.save(stream, "GIF", save_all=True, append_images=others, duration=round(1e3 / _RATE), loop=0)
        return stream.getvalue()

    def _frame(self, simulation: Simulation) -> Any:
        library, (width, height) = self._library, _SIZE
        scene, context = self._drawn(simulation.model)
        camera, options = library.MjvCamera(), library.MjvOption()
        forward, center = self._forward(simulation), simulation.data.body(OBJECT).xpos.copy()
        camera.lookat[:], camera.distance = center, _DISTANCE
        camera.azimuth = math.degrees(math.atan2(forward[1], forward[0]))
        camera.elevation = math.degrees(math.asin(forward[2]))
        everything = library.mjtCatBit.mjCAT_ALL
        library.mjv_updateScene(simulation.model, simulation.data, options, None, camera, everything, scene)
        view, pixels = library.MjrRect(0, 0, width, height), np.empty((height, width, 3), dtype=np.uint8)
        library.mjr_render(view, scene, context)
        library.mjr_readPixels(pixels, None, view, context)
        image = self._pillow[0].fromarray(pixels[::-1])
        drawing = self._pillow[1].Draw(image)
        drawing.text((10, 10), simulation.phase, fill=(20, 20, 20), font_size=20)
        focus = height / 2 / math.tan(math.radians(simulation.model.vis.global_.fovy) / 2)
        for vector, length, colour in ((simulation.acceleration, 0.02, _RED), (simulation.spin, 0.01, _BLUE)):
            if np.linalg.norm(vector) > 0.0:
                _draw_arrow(drawing, _projected(length * vector, forward, focus), colour)
        return image.quantize(128)

    def _forward(self, simulation: Simulation) -> Array:
        """Return where to look: from above across the hand and a little along it, so that nothing hides the object."""
        along = simulation.data.body(OBJECT).xpos - simulation.model.body(1).pos  # the first body is the hand's base
        along = along / np.linalg.norm(along)
        aside = np.cross(self._across, along)
        forward = math.copysign(1.0, -aside[2]) * aside + _ALONG * along
        return np.asarray(forward / np.linalg.norm(forward))

    def _drawn(self, model: Any) -> tuple[Any, Any]:
        if self._drawing is None:
            context = self._library.MjrContext(model, self._library.mjtFontScale.mjFONTSCALE_100)
            self._library.mjr_setBuffer(self._library.mjtFramebuffer.mjFB_OFFSCREEN, context)
            self._drawing = self._library.MjvScene(model, maxgeom=1000), context
        return self._drawing


def _projected(vector: Array, forward: Array, focus: float) -> tuple[float, float]:
    """Return the pixel to which a vector from the middle of the picture leads; focus is the focal length in pixels."""
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    scale = focus / (_DISTANCE + float(vector @ forward))
    return _SIZE[0] / 2 + scale * float(vector @ right), _SIZE[1] / 2 - scale * float(vector @ up)


def _draw_arrow(drawing: Any, tip: tuple[float, float], colour: tuple[int, int, int]) -> None:
    """Draw an arrow from the middle of the picture; one that points at the viewer is a dot."""
    start = np.array(_SIZE) / 2
    shaft = np.array(tip) - start
    length = float(np.linalg.norm(shaft))
    drawing.ellipse([*(start - 4.0), *(start + 4.0)], fill=colour)
    if length > 1.0:
        along, across = shaft / length, np.array([-shaft[1], shaft[0]]) / length
        neck = start + (length - 14.0) * along
        drawing.line([*start, *neck], fill=colour, width=4)
        drawing.polygon([tuple(point) for point in (tip, neck + 7.0 * across, neck - 7.0 * across)], fill=colour)


def _context() -> Any:
    """Return a context that draws off screen, made current.

    Raises:
        InputError: there is none on this machine.
    """
    wanted = os.environ.get("MUJOCO_GL", "").lower()
    backends = (wanted,) if wanted in _BACKENDS else _BACKENDS
    reasons = []
    for name in backends:
        try:
            context = importlib.import_module(f"mujoco.{name}").GLContext(*_SIZE)
            context.make_current()
        except Exception as error:  # each of them fails in its own way where its library or a display is missing
            reasons.append(f"{name}: {type(error).__name__} {error}".splitlines()[0])
            continue
        return context
    raise InputError(
        f"no film can be drawn on this machine ({'; '.join(reasons)})",
        remedy="Install EGL or OSMesa (libegl1, libosmesa6), or open what `write_mjcf` writes on another machine",
    )
