"""The original collision meshes of a URDF, as trimesh reads them and as Coal measures them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import coal
import numpy as np
import trimesh
from numpy.typing import NDArray

from ..arrays import Array
from ..descriptions.robot import Composition
from ..errors import InputError

_SECTIONS = 128


@dataclass(frozen=True)
class LinkMesh:
    """All collision geometry of one link as one triangle mesh; link frame, metres."""

    link: str
    solid: Any
    """Coal's tree of the triangles."""
    triangles: Array
    """Shape (triangles, 3 corners, 3)."""
    hull: Array
    """Corners of the convex hull, shape (corners, 3)."""
    hull_faces: tuple[Array, Array]
    """Outward normals n, shape (faces, 3), and offsets d, shape (faces,): inside n . p <= d."""
    members: Array
    """One vertex of every connected part, shape (parts, 3)."""
    center: Array
    """Centre of the bounding sphere, shape (3,)."""
    radius: float

    def surrounds(self, points: Array) -> bool:
        """Whether one of the points, shape (n, 3), link frame, lies in what the mesh encloses.

        Distances to a mesh are distances to its skin; this tells when a body sits wholly under it. The
        winding number decides, which small holes in a mesh do not spoil.
        """
        normals, offsets = self.hull_faces
        candidates = points[(points @ normals.T <= offsets).all(axis=1)]
        return any(abs(self.winding_number(point)) > 0.5 for point in candidates)

    def winding_number(self, point: Array) -> float:
        """Sum of the solid angles of all triangles over 4 pi (van Oosterom and Strackee 1983)."""
        a, b, c = (self.triangles - point).transpose(1, 0, 2)
        la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        dots = [np.einsum("ij,ij->i", first, second) for first, second in ((a, b), (b, c), (c, a))]
        angles = 2 * np.arctan2(volume, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb)
        return float(angles.sum() / (4 * np.pi))


def read_meshes(urdf: Any, robot: Composition) -> dict[str, LinkMesh]:
    """Read the collision geometry of every link that has any.

    Raises:
        InputError: a mesh cannot be read.
    """
    return {
        name: _link_mesh(name, [_placed(collision, name, robot) for collision in link.collisions])
        for name, link in urdf.link_map.items()
        if link.collisions
    }


def _placed(collision: Any, link: str, robot: Composition) -> Any:
    """Return one `<collision>` as a mesh in the link frame."""
    geometry = collision.geometry
    if geometry.mesh is not None:
        mesh = _read(geometry.mesh.filename, link)
        scale = geometry.mesh.scale
        mesh.apply_scale(1.0 if scale is None else scale)
    elif geometry.box is not None:
        mesh = trimesh.creation.box(extents=geometry.box.size)
    elif geometry.sphere is not None:
        mesh = trimesh.creation.icosphere(subdivisions=4)
        # Facets outside the ball, never inside it.
        inscribed = np.einsum("ij,ij->i", mesh.face_normals, mesh.triangles_center).min()
        mesh.apply_scale(geometry.sphere.radius / inscribed)
    elif geometry.cylinder is not None:
        radius = geometry.cylinder.radius / np.cos(np.pi / _SECTIONS)
        mesh = trimesh.creation.cylinder(radius, geometry.cylinder.length, sections=_SECTIONS)
    else:
        raise InputError(f"link {link} has a collision geometry of unknown type", file=robot.urdf_file)
    return mesh if collision.origin is None else mesh.apply_transform(collision.origin)


def _read(file: str, link: str) -> Any:
    try:
        mesh = trimesh.load_scene(file).to_geometry()
        if not len(mesh.faces):
            raise ValueError("it has no triangles")
        # Without texture and colours, which keep vertices apart that are one.
        return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    except (OSError, ValueError, TypeError, KeyError, AttributeError, ImportError) as error:
        raise InputError(f"the collision mesh of link {link} cannot be read: {error}", file=Path(file)) from None


def _link_mesh(link: str, parts: list[Any]) -> LinkMesh:
    mesh = trimesh.util.concatenate(parts)
    vertices = np.array(mesh.vertices, dtype=np.float64)
    faces = np.array(mesh.faces, dtype=np.int64)
    hull = mesh.convex_hull
    corners = np.array(hull.vertices, dtype=np.float64)
    normals = np.array(hull.face_normals, dtype=np.float64)
    center = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return LinkMesh(
        link=link,
        solid=_tree(vertices, faces),
        triangles=vertices[faces],
        hull=corners,
        hull_faces=(normals, np.einsum("ij,ij->i", normals, hull.triangles_center)),
        members=_members(mesh),
        center=center,
        radius=float(np.linalg.norm(corners - center, axis=1).max()),
    )


def _tree(vertices: Array, faces: NDArray[np.int64]) -> Any:
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(faces), len(vertices))
    tree.addVertices(vertices)
    tree.addTriangles(faces)
    tree.endModel()
    tree.computeLocalAABB()
    return tree


def _members(mesh: Any) -> Array:
    merged = mesh.copy()
    merged.merge_vertices()
    groups = trimesh.graph.connected_components(merged.edges, nodes=merged.faces.ravel())
    return np.array([merged.vertices[group[0]] for group in groups], dtype=np.float64)
