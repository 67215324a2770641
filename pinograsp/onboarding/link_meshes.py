"""The collision geometry of links as triangle meshes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from ..arrays import Array
from ..geometry.mesh_file import meshes_of, read_triangles
from ..geometry.primitives import primitive_triangles
from ..geometry.triangle_mesh import TriangleMesh
from ..kinematics.collision_elements import LinkElement


def link_meshes(elements: Sequence[LinkElement]) -> dict[str, TriangleMesh]:
    """Return the mesh of every link that has collision geometry, link frame.

    Args:
        elements: those of one link after the other.

    Raises:
        InputError: a mesh file cannot be read.
    """
    return {
        link: TriangleMesh(np.concatenate([_placed(element) for element in group]))
        for link, group in groupby(elements, key=lambda element: element.link)
    }


def _placed(element: LinkElement) -> Array:
    R, p = element.origin[:3, :3], element.origin[:3, 3]
    return element_triangles(element) @ R.T + p


def element_triangles(element: LinkElement) -> Array:
    """Return the triangles of one collision element in its own frame, shape (n, 3, 3), m.

    Raises:
        InputError: the mesh file cannot be read.
    """
    if element.mesh is None:
        return primitive_triangles(element.kind, element.size)
    with meshes_of(element.link):
        triangles = read_triangles(element.mesh, element.size)
    mirrored = np.prod(element.size) < 0.0
    return triangles[:, ::-1] if mirrored else triangles
