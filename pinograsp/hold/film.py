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
from ..disk import write_whole
from ..errors import InputError
from ..results import Grasp
from .library import mujoco
from .mjcf import OBJECT, TIMESTEP, HandAndObject
from .options import HoldOptions
from .run import setup_of
from .simulation import LOOK_STEPS, Simulation

_SIZE = (640, 480)
_DISTANCE = 0.5
"""Of the camera from the object, m."""
_ALONG = 0.4
"""How much it looks along the hand."""
_RED, _BLUE = (0.85, 0.1, 0.1, 1.0), (0.1, 0.2, 0.85, 1.0)
_RATE = 20.0
"""Frames a second."""
_BACKENDS = ("egl", "osmesa", "glfw", "cgl")
"""MuJoCo's ways to draw, in the order in which they are tried: without a screen first."""


def write_film(grasp: Grasp, file: Path | str, options: HoldOptions | None = None) -> None:
    """Write an animated GIF of a grasp that settles, is shaken and turned.

    The base of the hand stays where it is: what moves is the object against the hand. An arrow shows the acceleration
    of the base.

    Args:
        grasp: of a result.
        file: to be written, ending in .gif.
        options: loads and control.

    Raises:
        InputError: as `hold_test`, the file's name does not end in .gif, it cannot be written, or nothing can draw on
            this machine.
    """
    file = Path(file)
    if file.suffix.lower() != ".gif":
        raise InputError("a film is a GIF", file=file, remedy="Give a name that ends in .gif")
    options = options or HoldOptions()
    model = HandAndObject(setup_of(grasp), options).model(grasp, shown=True)
    camera = _Camera(across=grasp.contacts[0].normal)
    simulation = Simulation(model, options, look=camera.look)
    try:
        for phase in simulation.phases():
            if phase.name in ("settle", "gravity") and not phase.in_place:
                break
    finally:
        camera.close()
    write_whole(file, camera.film())


class _Camera:
    """Takes a frame now and then.

    Args:
        across: direction in the world that should lie across the picture, shape (3,).
    """

    def __init__(self, across: Array) -> None:
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
        """Free what drawing needs."""
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
        from PIL import Image, ImageDraw

        library, (width, height) = self._library, _SIZE
        scene, context = self._drawn(simulation.model)
        camera, options = library.MjvCamera(), library.MjvOption()
        library.mjv_defaultFreeCamera(simulation.model, camera)
        self._aim(camera, simulation)
        everything = library.mjtCatBit.mjCAT_ALL
        library.mjv_updateScene(simulation.model, simulation.data, options, None, camera, everything, scene)
        self._add_load(scene, simulation)
        view, pixels = library.MjrRect(0, 0, width, height), np.empty((height, width, 3), dtype=np.uint8)
        library.mjr_render(view, scene, context)
        library.mjr_readPixels(pixels, None, view, context)
        image = Image.fromarray(pixels[::-1])
        ImageDraw.Draw(image).text((10, 10), f"{simulation.phase}   {simulation.data.time:.2f} s", fill=(20, 20, 20))
        return image.quantize(128)

    def _aim(self, camera: Any, simulation: Simulation) -> None:
        """Look from above across the hand, a little along it, so that fingers and object are seen side by side."""
        along = simulation.data.body(OBJECT).xpos - simulation.model.body(1).pos  # the first body is the hand's base
        along = along / np.linalg.norm(along)
        aside = np.cross(self._across, along)
        forward = math.copysign(1.0, -aside[2]) * aside + _ALONG * along
        x, y, z = forward / np.linalg.norm(forward)
        camera.azimuth, camera.elevation = math.degrees(math.atan2(y, x)), math.degrees(math.asin(z))
        camera.distance = _DISTANCE

    def _drawn(self, model: Any) -> tuple[Any, Any]:
        if self._drawing is None:
            context = self._library.MjrContext(model, self._library.mjtFontScale.mjFONTSCALE_100)
            self._library.mjr_setBuffer(self._library.mjtFramebuffer.mjFB_OFFSCREEN, context)
            self._drawing = self._library.MjvScene(model, maxgeom=1000), context
        return self._drawing

    def _add_load(self, scene: Any, simulation: Simulation) -> None:
        """Add an arrow along the acceleration of the base (red), or about which it turns (blue)."""
        center = simulation.data.body(OBJECT).xpos
        for vector, length, colour in ((simulation.acceleration, 0.02, _RED), (simulation.spin, 0.01, _BLUE)):
            if np.linalg.norm(vector) > 0.0:
                arrow, kind = scene.geoms[scene.ngeom], self._library.mjtGeom.mjGEOM_ARROW
                self._library.mjv_initGeom(arrow, kind, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.array(colour))
                self._library.mjv_connector(arrow, kind, 0.004, center, center + length * vector)
                scene.ngeom += 1


def _context() -> Any:
    """Return a context that draws off screen, made current.

    Raises:
        InputError: there is none on this machine.
    """
    wanted = os.environ.get("MUJOCO_GL", "").lower()
    backends = (wanted,) if wanted in _BACKENDS else _BACKENDS
    for name in backends:
        try:
            context = importlib.import_module(f"mujoco.{name}").GLContext(*_SIZE)
            context.make_current()
        except Exception:
            continue
        return context
    raise InputError(
        f"no film can be drawn on this machine: tried {', '.join(backends)}",
        remedy="Install EGL or OSMesa (libegl1, libosmesa6), or write the model with --mjcf and open it elsewhere",
    )
