"""The part of a pad's own link that stands out beside the pad: it may touch the object no more than another link may.

A convex object that is tangent to a pad lies wholly above the pad's tangent plane. Of a flat pad that is the pad's own
plane, so what of the link is flush with it or behind it cannot be touched, and counts as rubber or its backing. What is
above the plane by more than `PENETRATION` stands out; triangles are cut there. Of a curved pad the surface continued is
the whole sphere or cylinder, and triangles that reach more than `BULGE` outside it stand out.

Of a compound that is so of the part that a pad touches. Other parts may be beside or behind the pad's surface: the pad
clearance, which is of the whole link, keeps them out of it. A mesh may dip into the rubber of a pad, which
`rubber` measures.

A link with several pads is touched at each of them, so that only what stands out above all of them counts.
"""

from __future__ import annotations

import numpy as np
import trimesh

from ..descriptions.patches import CylinderPatch, Patch, SpherePatch
from ..memo import remembered
from .link_mesh import LinkMesh
from .patches import heights
from .robot import VerifiedRobot
from .shapes.core import PENETRATION

BULGE = 1e-4
"""How far a triangle may reach out of a curved pad's surface continued, m: facets do not follow it exactly."""

Placed = tuple[str, Patch]


@remembered
def standing_out(robot: VerifiedRobot, pads: tuple[Placed, ...]) -> dict[str, LinkMesh]:
    """Return the parts that stand out of the links with pads, by link; links of which nothing does are left out.

    Args:
        robot: its meshes.
        pads: link and patch of each pad.
    """
    patches: dict[str, list[Patch]] = {}
    for link, patch in pads:
        patches.setdefault(link, []).append(patch)
    found = {}
    for link, mesh in robot.meshes.items():
        if link in patches:
            part = _part(mesh, patches[link])
            if part is not None:
                found[link] = part
    return found


def _part(mesh: LinkMesh, patches: list[Patch]) -> LinkMesh | None:
    vertices, faces = mesh.vertices, mesh.faces
    for patch in patches:
        if isinstance(patch, CylinderPatch | SpherePatch):
            faces = faces[(heights(patch, vertices) > BULGE)[faces].any(axis=1)]
        else:
            normal = patch.rotation[:, 2]
            origin = np.array(patch.origin) + PENETRATION * normal
            vertices, faces = trimesh.intersections.slice_faces_plane(vertices, faces, normal, origin)[:2]
        if not len(faces):
            return None
    return mesh.opened(vertices, faces)
