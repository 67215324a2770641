"""meshcat: the one place that imports it, and a viewer without a server for the HTML page."""

from __future__ import annotations

import contextlib
import io
import warnings
from pathlib import Path
from typing import Any

from ..words import escaped

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # meshcat 0.3.2 imports a deprecated part of pyzmq
    from meshcat import Visualizer, geometry
    from meshcat.servers.zmqserver import VIEWER_ROOT

__all__ = ["LayeredMesh", "Recorder", "Visualizer", "child", "clear_backdrop", "geometry", "live", "viewer_javascript"]


class LayeredMesh(geometry.Mesh):  # type: ignore[misc]
    """A mesh that three.js paints after those of a lower layer.

    meshcat writes the keys of properties in lower case, so `renderOrder` has to come with the object.
    """

    def __init__(self, shape: Any, material: Any, layer: int) -> None:
        super().__init__(shape, material)
        self.layer = layer

    def lower(self) -> Any:
        """Return the object as three.js reads it."""
        data = super().lower()
        data["object"]["renderOrder"] = self.layer
        return data


class Recorder:
    """Stands in for meshcat's window: keeps what is drawn, in order, instead of sending it to a server."""

    def __init__(self) -> None:
        self.commands: list[dict[str, Any]] = []

    def send(self, command: Any) -> None:
        """Keep one drawing command (called by meshcat)."""
        self.commands.append(command.lower())


def live() -> Visualizer:
    """Start a meshcat server and return its visualizer; opens no browser, `url()` is the address."""
    with contextlib.redirect_stdout(io.StringIO()):
        return Visualizer()


def child(node: Visualizer, name: str) -> Visualizer:
    """Return the node below another one for a thing of any name: a slash in it would lead to the node of another."""
    return node[escaped(name, "/")]


def clear_backdrop(node: Visualizer) -> None:
    """Take meshcat's grid and axes away, and show all of its tree before a light background.

    Args:
        node: any node of the tree.
    """
    for name in ("/Grid", "/Axes"):
        node[name].set_property("visible", False)
    node["/Background"].set_property("top_color", [1.0, 1.0, 1.0])
    node["/Background"].set_property("bottom_color", [0.93, 0.94, 0.96])


def viewer_javascript() -> str:
    """Return the JavaScript of meshcat's viewer, which defines `MeshCat.Viewer`."""
    return (Path(VIEWER_ROOT) / "main.min.js").read_text(encoding="utf-8")
