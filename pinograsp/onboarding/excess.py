"""How far the convex pieces that stand for a link reach beyond its meshes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from ..geometry.cover_cache import mesh_cover
from ..geometry.hulls import Hull, boundary
from ..geometry.mesh_file import meshes_of
from ..geometry.mesh_surface import MeshSurface
from ..kinematics.collision_elements import collision_elements
from ..kinematics.robot import Robot
from ..progress import Progress, Report
from .link_meshes import element_triangles

SAMPLES = 1500


def excess(pieces: Sequence[Array], triangles: Array, samples: int = SAMPLES) -> Array:
    """Return distances to a mesh of points spread over the outer boundary of the union of convex pieces, m.

    Args:
        pieces: vertices, each of shape (k, 3).
        triangles: of the mesh, shape (n, 3, 3).
        samples: points before those within another piece are taken out.
    """
    points, _ = boundary([Hull(vertices) for vertices in pieces], samples)
    return MeshSurface(triangles).distances(points)


def link_covers(robot: Robot, report: Report) -> dict[str, tuple[int, Array]]:
    """Return for every link with collision geometry how many pieces stand for it, and their excess, m.

    Args:
        robot: the robot.
        report: called before every mesh.
    """
    found: dict[str, tuple[int, Array]] = {}
    elements = collision_elements(robot)
    for done, element in enumerate(elements):
        report(Progress("convex pieces", done, len(elements)))
        count, distances = found.get(element.link, (0, np.zeros(1)))
        if element.mesh is None:
            found[element.link] = (count + 1, distances)
            continue
        with meshes_of(element.link):
            pieces = mesh_cover(element.mesh, element.size, *robot.description.collision.of(element.link))
        beyond = excess(pieces, element_triangles(element))
        found[element.link] = (count + len(pieces), np.concatenate([distances, beyond]))
    return found
