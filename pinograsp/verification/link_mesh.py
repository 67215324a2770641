"""All collision geometry of one link as one triangle mesh, measured by Coal, and kept in the user's cache folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import igl
import numpy as np

from ..array_cache import kept
from ..arrays import Array, Integers
from ..disk import digest
from .coal_bodies import hull_corners, hull_solid, triangle_tree

NOTHING = (np.zeros((1, 3)), np.array([-1.0]))
"""Planes of a hull inside of which nothing is."""
VERSION = 2
"""Of what is kept; to be raised with every change of how a mesh is read or what is kept of it."""


@dataclass(frozen=True)
class LinkMesh:
    """A link; link frame, metres."""

    link: str
    vertices: Array
    """Shape (vertices, 3)."""
    faces: Integers
    """Shape (triangles, 3)."""
    hull: Array
    """Corners of the convex hull, shape (corners, 3)."""
    hull_faces: tuple[Array, Array]
    """Outward normals n, shape (faces, 3), and offsets d, shape (faces,): inside n . p <= d."""
    members: Array
    """One vertex of every connected part, shape (parts, 3)."""
    center: Array
    """Centre of the bounding sphere, shape (3,)."""
    radius: float

    @cached_property
    def triangles(self) -> Array:
        """Shape (triangles, 3 corners, 3)."""
        return np.asarray(self.vertices[self.faces])

    @cached_property
    def solid(self) -> Any:
        """Coal's tree of the triangles; made when a distance is first measured."""
        return triangle_tree(self.vertices, self.faces)

    @cached_property
    def hull_solid(self) -> Any | None:
        """Coal's convex hull, or what is a little larger; None of what is flat."""
        return hull_solid(self.hull)

    @cached_property
    def _winding(self) -> Any:
        hierarchy = igl.FastWindingNumberBVH()
        hierarchy.init(self.vertices, self.faces)
        return hierarchy

    def surrounds(self, points: Array) -> bool:
        """Whether one of the points, shape (n, 3), link frame, lies in what the mesh encloses.

        Distances to a mesh are distances to its skin; this tells when a body sits wholly under it. The
        winding number decides, which small holes in a mesh do not spoil.
        """
        normals, offsets = self.hull_faces
        low, high = self.hull.min(axis=0), self.hull.max(axis=0)
        near = points[((points >= low) & (points <= high)).all(axis=1)]
        if not len(near):
            return False
        wound = near[np.abs(self._winding.winding_number(near)) > 0.5]  # of few points the whole hull is looked at
        return bool((wound @ normals.T <= offsets).all(axis=1).any())

    def opened(self, vertices: Array, faces: Integers) -> LinkMesh:
        """Return triangles that were cut out of the mesh; cut open, they enclose nothing.

        Whether something is inside the link is to be asked of the whole link.

        Args:
            vertices: shape (v, 3), m.
            faces: which of them are used, shape (f, 3).
        """
        used, numbers = np.unique(faces, return_inverse=True)
        corners = np.asarray(vertices[used], dtype=np.float64)
        return replace(
            self,
            vertices=corners,
            faces=numbers.reshape(-1, 3).astype(np.int64),
            hull=hull_corners(corners),
            hull_faces=NOTHING,
            members=corners[:1],
            radius=float(np.linalg.norm(corners - self.center, axis=1).max()),
        )


def kept_mesh(link: str, content: bytes, make: Callable[[], LinkMesh]) -> LinkMesh:
    """Return the mesh of a link from the cache folder, or make it and keep it.

    Args:
        link: its name.
        content: all that decides the mesh.
        make: makes it.
    """
    key = digest(b"%d " % VERSION + content)
    return kept("meshes", key[:32], make, _arrays_of, lambda arrays: _mesh_of(link, arrays))


_ARRAYS = tuple(field.name for field in fields(LinkMesh) if field.name not in ("link", "hull_faces"))


def _arrays_of(mesh: LinkMesh) -> dict[str, Any]:
    normals, offsets = mesh.hull_faces
    return {"hull_normals": normals, "hull_offsets": offsets} | {name: getattr(mesh, name) for name in _ARRAYS}


def _mesh_of(link: str, arrays: Mapping[str, Any]) -> LinkMesh:
    found = {name: arrays[name] for name in _ARRAYS}
    found["radius"] = float(found["radius"])
    return LinkMesh(link, hull_faces=(arrays["hull_normals"], arrays["hull_offsets"]), **found)
