"""Jaws that open wider, as an object that is narrower; those that close further, as one that is wider."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from ...arrays import Array
from ...descriptions.bodies import Body
from ...descriptions.shapes import Box, Capsule, Cone, Cylinder, Ellipsoid, Mesh, Sphere
from ...errors import InputError
from ...geometry.shapes import surface_of
from .variant import SMALL, Change, Failure, Variant, place

REFUSED = "objects.shape"
"""Key of the refusal of an object that does not fit the jaw."""


def jaws(failure: Failure) -> Iterator[Change]:
    """Yield a jaw that opens wider, as an object that is so much narrower between its desired contacts, or across.

    Contacts that are proposed fit the jaw: without desired ones only an object that is refused needs another one. If it
    is thinner than the jaw closes, that is one that closes further. There is none where more is missing than is tried.
    """
    task, body = failure.task, failure.target
    if task.desired_contacts is None and REFUSED not in failure.kinds:
        return
    points = np.array(task.desired_contacts or ()).reshape(-1, 3)
    if len(points) not in (0, 2):
        return
    surface = surface_of(body.shape)
    normals = surface.signed_distance(points)[1] if len(points) else points
    widths = [surface.extent(axis) + surface.extent(-axis) for axis in np.eye(3)]
    least, most = failure.jaw or (0.0, 0.0)
    narrowest = abs(float((points[0] - points[1]) @ normals[0])) if len(points) else surface.least_width

    def changes(size: float) -> Mapping[str, Any]:
        shape = _narrower(body, normals, size)
        moved = points - 0.5 * size * normals
        found: dict[str, Any] = {place("objects", task.object, "shape"): shape}
        if len(points):
            found[place("tasks", failure.task_name, "desired_contacts")] = moved.tolist()
        return found

    def text(size: float) -> str:
        return f"a jaw that opens {1e3 * size:.1f} mm wider, or {task.object!r} narrower by as much"

    def tried(size: float) -> str:
        return f"a jaw that opens up to {1e3 * size:.1f} mm wider, or {task.object!r} narrower by as much"

    def closing(size: float) -> str:
        return f"a jaw that closes {1e3 * size:.1f} mm further, or {task.object!r} wider by as much"

    def tried_closing(size: float) -> str:
        return f"a jaw that closes up to {1e3 * size:.1f} mm further, or {task.object!r} wider by as much"

    if not len(points) and min(widths) < least:
        closes = Variant(lambda size: changes(-size), lambda size: size, closing)
        yield from _jaw(least - min(widths), closes, tried_closing)
    if len(points) or max(widths) > most:
        opens = Variant(changes, lambda size: size, text)
        yield from _jaw(narrowest - most if failure.jaw else 0.0, opens, tried)


def _jaw(missing: float, variant: Variant, tried: Callable[[float], str]) -> Iterator[Change]:
    """Yield a jaw that opens wider or closes further, by no less than is missing, if that is not too much to try."""
    sizes = tuple(size for size in SMALL if size >= missing)
    if sizes:
        yield Change("jaw", "m", 1e-4, sizes, (variant,), tried)


def _narrower(body: Body, normals: Array, size: float) -> Mapping[str, Any]:
    """Return the shape of a body that is narrower across the normals, or where it is narrowest, as JSON data.

    A mesh is made smaller as a whole. Where the size is negative, it is wider by as much.

    Raises:
        InputError: there is no such shape.
    """
    shape = body.shape
    match shape:
        case Sphere() | Cylinder() | Capsule():
            changed: Mapping[str, Any] = {"radius": shape.radius - 0.5 * size}
        case Box():
            axis = int(np.abs(normals[0]).argmax()) if len(normals) else int(np.argmin(shape.size))
            changed = {"size": tuple(s - size * (i == axis) for i, s in enumerate(shape.size))}
        case Ellipsoid():
            axis = int(np.abs(normals[0]).argmax()) if len(normals) else int(np.argmin(shape.semi_axes))
            changed = {"semi_axes": tuple(s - 0.5 * size * (i == axis) for i, s in enumerate(shape.semi_axes))}
        case Cone() if not len(normals):
            radii = {"bottom_radius": shape.bottom_radius, "top_radius": shape.top_radius}
            changed = {name: max(0.0, radius - 0.5 * size) for name, radius in radii.items()}
        case Mesh() if not len(normals):
            part = 1.0 - size / surface_of(shape).least_width
            changed = {"scale": tuple(part * scale for scale in shape.scales)}
        case _:
            raise InputError(f"a shape of type {shape.type} is not made narrower")
    return shape.model_copy(update=changed).model_dump(mode="json", exclude_none=True)
