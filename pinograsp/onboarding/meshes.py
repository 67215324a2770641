"""Findings about meshes: are they there, closed, of a credible size, and how well do convex pieces stand for them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping

import coal
import numpy as np
import pinocchio as pin

from ..descriptions.mesh_files import METRES
from ..geometry.triangle_mesh import TriangleMesh, winding_number
from ..kinematics.collision_elements import collision_elements
from ..kinematics.robot import Robot
from ..kinematics.shown_geometry import shown_of
from ..kinematics.tree import UrdfTree
from ..progress import Report, no_report
from ..words import in_words
from .excess import link_covers
from .findings import Finding, LinkFigures

LOOSE = 0.010
"""An excess beyond this keeps the robot farther off than it need be, m."""
LARGEST, SMALLEST = 3.0, 0.002
"""Extents of a link beyond these are those of a mesh in other units, m."""
MODEST = 0.3
"""A link of this size is never too large, m."""
LIKELY = 0.01
"""Links that are larger, m, may be in the unit that makes them so."""
_UP_AXIS = re.compile(rb"<up_axis>\s*([XYZ])_UP\s*</up_axis>")
_SAMPLES = 48


def link_figures(robot: Robot, meshes: Mapping[str, TriangleMesh], report: Report = no_report) -> list[LinkFigures]:
    """Return the figures of every link with collision geometry.

    Args:
        robot: the robot.
        meshes: of its links.
        report: called before every mesh.
    """
    found = []
    for link, (pieces, distances) in link_covers(robot, report).items():
        excess = float(np.percentile(distances, 95))
        count = len(meshes[link].triangles)
        found.append(LinkFigures(link, count, meshes[link].closed, pieces, excess, float(distances.max())))
    return found


def mesh_findings(figures: list[LinkFigures], meshes: Mapping[str, TriangleMesh], robot: Robot) -> Iterator[Finding]:
    """Judge the meshes."""
    open_ones = [figure.link for figure in figures if not figure.closed]
    leaky = [link for link in open_ones if not encloses(meshes[link])]
    for link in leaky:
        remedy = "Close it (a repair tool, or its convex hull): what lies wholly inside is not noticed"
        yield Finding("doubtful", f"the mesh of {link} is not watertight: inside and outside cannot be told", remedy)
    if not leaky:
        cracks = f"; cracks in {in_words(open_ones)} are too fine to matter" if open_ones else ""
        yield Finding("ok", f"collision geometry of {len(figures)} links, all found and watertight{cracks}")
    yield from _sizes(meshes, robot)
    yield from _turned(robot)
    loose = [figure for figure in figures if figure.excess > LOOSE]
    for figure in loose:
        yield Finding(
            "doubtful",
            f"the pieces of {figure.link} stand off its mesh by {1e3 * figure.excess:.1f} mm (95th percentile)",
            f"Raise collision.links.{figure.link}.pieces, or lower its tolerance",
        )
    worst = max(figures, key=lambda figure: figure.excess, default=None)
    if worst is not None and 0.0 < worst.excess <= LOOSE:
        yield Finding("ok", f"convex pieces stand off by at most {1e3 * worst.excess:.1f} mm ({worst.link})")
    yield from _without_geometry(meshes, robot)


def _sizes(meshes: Mapping[str, TriangleMesh], robot: Robot) -> Iterator[Finding]:
    """Find links that are too large or too small for what they are a part of, as those in another unit are."""
    reach = _reach(robot.urdf.tree)
    for link, mesh in meshes.items():
        size = float(np.ptp(mesh.corners, axis=0).max())
        moved = bool(robot.urdf.tree.path(link))
        most = min(LARGEST, max(MODEST, reach)) if moved else LARGEST
        if not SMALLEST < size < most:
            likely = [unit for unit, metres in METRES.items() if LIKELY < metres * size < 0.5 * most]
            in_units = ", ".join(f"in {unit}, {1e3 * METRES[unit] * size:.3g} mm ({METRES[unit]:g})" for unit in likely)
            long = f", and the robot without it {reach:.2g} m long" if size < LARGEST and size >= most else ""
            remedy = f"If its mesh is {in_units}: give the factor as its scale" if likely else "Is its unit the metre?"
            yield Finding("doubtful", f"link {link} is {size:.4g} m large{long}", remedy)
    poses, joints = robot.urdf.tree.poses({}), robot.urdf.tree.joints.values()
    far = {joint.name: math.dist(poses[joint.child][:3, 3], poses[joint.parent][:3, 3]) for joint in joints}
    beyond = [f"{name} ({length:.4g} m)" for name, length in far.items() if length > LARGEST]
    if beyond:
        what = f"joints that are far from their parent links: {in_words(beyond)}"
        yield Finding(
            "doubtful", what, "Are their origins in metres? Those of a file in mm are a thousand times as large"
        )


def _reach(tree: UrdfTree) -> float:
    """Return the length of the longest chain of joints from the root, m, with what they slide."""
    poses, along = tree.poses({}), {tree.root: 0.0}
    above = {joint.child: joint for joint in tree.joints.values()}
    for link in tree.links[1:]:
        joint = above[link]
        slide = max(map(abs, joint.limits)) if joint.kind == "prismatic" else 0.0
        step = float(np.linalg.norm(poses[link][:3, 3] - poses[joint.parent][:3, 3]))
        along[link] = along[joint.parent] + step + slide
    return max(along.values())


def _turned(robot: Robot) -> Iterator[Finding]:
    """Find COLLADA files that state another upward axis than URDFs have: readers of URDFs differ on what that means."""
    for element in collision_elements(robot):
        if element.mesh is not None and element.mesh.suffix.lower() == ".dae":
            axis = _UP_AXIS.search(element.mesh.read_bytes())
            if axis is not None and axis[1] != b"Z":
                what = f"{element.mesh.name} of link {element.link} says {axis[1].decode()}_UP"
                remedy = (
                    "It is taken as it stands, as RViz and MoveIt do; look at it on the page, turn it by its <origin>"
                )
                yield Finding("doubtful", what, remedy)


def encloses(mesh: TriangleMesh) -> bool:
    """Whether points are clearly inside or outside: winding numbers near whole ones, in spite of holes."""
    low, high = mesh.corners.min(axis=0), mesh.corners.max(axis=0)
    points = np.random.default_rng(0).uniform(low, high, (_SAMPLES, 3))
    windings = np.array([winding_number(mesh.triangles, point) for point in points])
    return bool((np.abs(windings - windings.round()) < 0.2).mean() > 0.95)


def _without_geometry(meshes: Mapping[str, TriangleMesh], robot: Robot) -> Iterator[Finding]:
    """Find what would move unseen, and what cannot be shown."""
    frames = {
        link: robot.model.getFrameId(link, pin.BODY) for link in robot.urdf.links
    }  # a joint may be called so, too
    body = {link: robot.model.frames[frame].parentJoint for link, frame in frames.items()}
    solid, loader = {body[link] for link in meshes}, coal.CachedMeshLoader()
    for link in robot.urdf.composed.tree.findall("link"):
        name = link.get("name", "")
        if link.find("visual") is not None and body[name] not in solid:
            remedy = "Give it a <collision>: the planner does not see it"
            yield Finding("doubtful", f"link {name} has no collision geometry", remedy)
        for problem in shown_of(link, robot.description.urdf_file, loader).problems:
            remedy = "Only pictures need it: mend it; if a mesh was not found, name its folder under `packages`"
            yield Finding("doubtful", f"link {name} is not drawn as it is to be shown: {problem}", remedy)
