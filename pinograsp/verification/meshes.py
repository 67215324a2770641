"""The original collision meshes of a URDF, as trimesh reads them."""

from __future__ import annotations

import io
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from ..arrays import Array
from ..descriptions.composition import Composition
from ..descriptions.mesh_damage import unreadable
from ..descriptions.mesh_files import mesh_bytes
from ..descriptions.obj_indices import counted_from_first
from ..errors import FileError, InputError
from .link_mesh import NOTHING, LinkMesh, kept_mesh

_SECTIONS = 128
_FARTHEST = 1e3
"""Distance of a corner from the origin of its mesh, m: no link is larger."""
_SHEET = 1e-6
"""Thickness of a mesh, as a share of its extent, below which it encloses nothing."""


def read_meshes(urdf: Any, robot: Composition) -> dict[str, LinkMesh]:
    """Read the collision geometry of every link that has any; it is kept in the user's cache folder.

    Raises:
        InputError: a mesh cannot be read.
    """
    return {
        name: kept_mesh(name, _content(link.collisions, name), partial(_of_collisions, link.collisions, name, robot))
        for name, link in urdf.link_map.items()
        if link.collisions
    }


def _of_collisions(collisions: list[Any], link: str, robot: Composition) -> LinkMesh:
    return _link_mesh(link, [_placed(collision, link, robot) for collision in collisions])


def _content(collisions: list[Any], link: str) -> bytes:
    """Return all that decides the mesh of a link: what the URDF says, and the mesh files."""
    parts = []
    for collision in collisions:
        geometry, origin = collision.geometry, collision.origin
        shapes = (geometry.mesh, geometry.box, geometry.sphere, geometry.cylinder)
        numbers = [
            {name: _exact(value) for name, value in vars(shape).items()} for shape in shapes if shape is not None
        ]
        parts.append(repr((numbers, _exact(origin))).encode())
        if geometry.mesh is not None:
            parts.append(_bytes(geometry.mesh.filename, link))
    return b"\0".join(parts)


def _exact(value: Any) -> Any:
    """Return an array as nested lists, whose text keeps every digit; anything else as it is."""
    return value.tolist() if isinstance(value, np.ndarray) else value


def _placed(collision: Any, link: str, robot: Composition) -> Any:
    """Return one `<collision>` as a mesh in the link frame."""
    geometry = collision.geometry
    if geometry.mesh is not None:
        mesh = _read(geometry.mesh.filename, link)
        scale = geometry.mesh.scale
        mesh.apply_scale(1.0 if scale is None else scale)
        if not (farthest := np.abs(mesh.vertices).max()) <= _FARTHEST:
            problem = f"the collision mesh of link {link} has a corner that is {farthest:.3g} m from its origin"
            raise FileError(problem, file=Path(geometry.mesh.filename), remedy="Check its numbers, and its `scale`")
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


def _bytes(file: str, link: str) -> bytes:
    try:
        return mesh_bytes(Path(file))
    except FileError as error:
        raise FileError(error.problem, file=error.file, key=f"link {link}", remedy=error.remedy) from None


def _read(file: str, link: str) -> Any:
    """Return the triangles of a mesh file in metres, by the unit that it states."""
    kind, content, key = Path(file).suffix[1:].lower(), _bytes(file, link), f"link {link}"
    try:
        with warnings.catch_warnings():  # of a mesh that was made elsewhere
            warnings.simplefilter("ignore")
            counted = io.BytesIO(counted_from_first(content, kind))
            # Not processed, which takes out corners that are no numbers.
            scene: Any = trimesh.load_scene(counted, file_type=kind, process=False)
            whole = scene.to_geometry()
            stated = 1.0 if scene.units is None else float(trimesh.units.unit_conversion(scene.units, "meters"))
        if not len(whole.faces):
            raise FileError("has no triangles", file=Path(file), key=key, remedy="Export it again")
        used = np.unique(whole.faces)
        if not np.isfinite(whole.vertices[used]).all() or not 0.0 < stated < np.inf:
            raise FileError("has corners that are not finite", file=Path(file), key=key, remedy="Export it again")
        # Without texture and colours, which keep vertices apart that are one, and corners that no triangle has.
        faces = np.searchsorted(used, whole.faces)
        mesh = trimesh.Trimesh(np.asarray(whole.vertices)[used] * stated, faces, process=False)
        mesh.merge_vertices()
        return mesh
    except FileError:
        raise
    except Exception as error:  # of any kind, from a parser that is given any bytes
        found = unreadable(content, Path(file))
        raise FileError(found.problem, file=found.file, key=key, remedy=found.remedy) from error


def _link_mesh(link: str, parts: list[Any]) -> LinkMesh:
    mesh = trimesh.util.concatenate(parts)
    vertices = np.array(mesh.vertices, dtype=np.float64)
    faces = np.array(mesh.faces, dtype=np.int64)
    if _is_sheet(vertices):  # both of its sides are outside
        corners, planes = vertices, NOTHING
    else:
        hull = mesh.convex_hull
        normals = np.array(hull.face_normals, dtype=np.float64)
        corners, planes = hull.vertices, (normals, np.einsum("ij,ij->i", normals, hull.triangles_center))
    corners = np.array(corners, dtype=np.float64)
    center = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return LinkMesh(
        link=link,
        vertices=vertices,
        faces=faces,
        hull=corners,
        hull_faces=planes,
        members=_members(mesh),
        center=center,
        radius=float(np.linalg.norm(corners - center, axis=1).max()),
    )


def _is_sheet(points: Array) -> bool:
    """Whether points, shape (n, 3), lie in one plane."""
    away = points - points.mean(axis=0)
    lengths = np.ptp(away @ np.linalg.svd(away.T @ away)[0], axis=0)
    return bool(lengths.min() <= _SHEET * lengths.max())


def _members(mesh: Any) -> Array:
    merged = mesh.copy()
    merged.merge_vertices()
    groups = trimesh.graph.connected_components(merged.edges, nodes=merged.faces.ravel())
    return np.array([merged.vertices[group[0]] for group in groups], dtype=np.float64)
