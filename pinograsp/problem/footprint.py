"""How far the footprints of the contacts of a state reach, with derivatives.

A footprint is the part that pad and object share of their contact faces. It is looked at along rays from the contact
point c to where the pad ends: along the straight line in which a flat pad touches a cylinder, or to the corners of a
pad that lies on a flat face. A ray ends at a point e that is

    fixed to the pad, a corner or the end of a line:     de = velocity of the pad at e,
    where a line c + t d of the object crosses a rim     de = dl - d (a . (dl - velocity of the pad at e)) / (a . d)
    of the pad with normal a:                            dl = dc + t (derivative of d as c moves) dc

The object may end before: then the ray has last points, which belong to the object's edges.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from ..descriptions.patches import CylinderPatch, LinePatch, PlanePatch
from ..geometry.contact_faces import ContactFace, Flat, Ruling, clipped
from ..geometry.patches import rectangle
from .state import State

PARALLEL = math.sin(math.radians(1.0))
"""Two straight lines whose angle has a sine below this touch along a line, others at a point."""
EDGE = 1e-7
"""A rim that is nearer to the contact point than this counts as so far away, m: a line along a rim stays whole."""
RAYS = {PlanePatch: 4, LinePatch: 4, CylinderPatch: 2}
"""Rays at most from a contact on each kind of patch; none from others, which touch at a point."""


@dataclass(frozen=True)
class Ray:
    """A way from a contact point to where its pad ends."""

    end: Array
    """World, m, shape (3,)."""
    d_end: Array
    """In x, shape (3, v)."""
    last: Array | None = None
    """Points of the footprint on edges of the object, if the object ends before the pad; world, m, shape (k, 3)."""


def rays(state: State, pad: int) -> list[Ray]:
    """Return the rays of the contact of a pad, none where it touches at a point."""
    patch, face = state.model.robot.pads[pad].patch, state.contact_faces[pad]
    if isinstance(patch, PlanePatch | LinePatch):
        if isinstance(face, Ruling):
            return _along(state, pad, face, rectangle(patch))
        return _to_corners(state, pad, face, rectangle(patch)) if isinstance(face, Flat) else []
    return _of_line(state, pad, face, patch) if isinstance(patch, CylinderPatch) else []


def frame(state: State, pad: int) -> tuple[Array, Array]:
    """Return rotation (3, 3) and origin (3,) of a patch frame in the world."""
    described, configuration = state.model.robot.pads[pad], state.configuration
    R, origin = configuration.rotations[described.joint], configuration.translations[described.joint]
    return R @ described.rotation, R @ described.translation + origin


def moves(state: State, pad: int, point: Array) -> Array:
    """Return the velocity of a point of a pad per rate of x, shape (3, v)."""
    contacts = state.contacts
    at, linear, angular = contacts.points[pad], contacts.linear[pad], contacts.angular[pad]
    return _velocities(point, at, linear, angular, state.model.robot.B, len(state.x))


@compiled
def _velocities(point: Array, at: Array, linear: Array, angular: Array, B: Array, size: int) -> Array:
    moves, arm = np.zeros((3, size)), point - at
    for k in range(len(B)):
        for x in range(3):
            y, z = (x + 1) % 3, (x + 2) % 3
            velocity = linear[x, k] + angular[y, k] * arm[z] - angular[z, k] * arm[y]
            for variable in range(B.shape[1]):
                moves[x, variable] += velocity * B[k, variable]
    return moves


def _along(state: State, pad: int, line: Ruling, ranges: Array) -> list[Ray]:
    """Return the two rays along a straight line of the object, up to the rims of a flat pad."""
    contacts = state.contacts
    R, origin = frame(state, pad)
    c, d = contacts.points[pad], line.direction
    reaches, ends, d_ends = _crossings(
        R,
        origin,
        c,
        contacts.d_points[pad],
        d,
        np.zeros((3, 3)) if line.bend is None else line.bend,
        ranges,
        contacts.linear[pad],
        contacts.angular[pad],
        state.model.robot.B,
    )
    edges = line.low, line.high
    return [
        Ray(ends[i], d_ends[i], None if reaches[i] <= abs(edge) else (c + edge * d)[None])
        for i, edge in enumerate(edges)
    ]


@compiled
def _crossings(
    R: Array,
    origin: Array,
    c: Array,
    d_c: Array,
    d: Array,
    bend: Array,
    ranges: Array,
    linear: Array,
    angular: Array,
    B: Array,
) -> tuple[Array, Array, Array]:
    """Return how far it is from c against and along d to a rim, m, shape (2,), the points there and their derivatives.

    Args:
        R: of the patch frame, shape (3, 3).
        origin: of the patch frame, world, m, shape (3,).
        c: the contact point, world, m, shape (3,).
        d_c: its derivative, shape (3, v).
        d: direction of the line, shape (3,).
        bend: derivative of d in c, 1/m, shape (3, 3).
        ranges: of the patch along x and y of its frame, m, shape (2, 2).
        linear: velocity of the pad at c, shape (3, nv).
        angular: angular velocity of the pad, shape (3, nv).
        B: rates of the joints per rate of the posture, shape (nv, l + s).
    """
    reaches, ends, d_ends = np.empty(2), np.empty((2, 3)), np.empty((2, 3, d_c.shape[1]))
    for side in range(2):
        sign = -1.0 if side == 0 else 1.0
        reaches[side], rim, slope, moving = np.inf, 0, 1.0, False
        for axis in range(2):
            along, at = 0.0, 0.0
            for k in range(3):
                along += sign * R[k, axis] * d[k]
                at += R[k, axis] * (c[k] - origin[k])
            if along != 0.0:
                room = ranges[axis, 1] - at if along > 0.0 else at - ranges[axis, 0]
                t = max(EDGE, room) / abs(along)
                if t < reaches[side]:
                    reaches[side], rim, slope, moving = t, axis, sign * along, room > EDGE
        ends[side] = c + sign * reaches[side] * d
        moves = _velocities(ends[side], c, linear, angular, B, d_c.shape[1])
        d_line = d_c + sign * reaches[side] * (bend @ d_c)
        for variable in range(d_c.shape[1]):
            across = 0.0
            if moving:
                for k in range(3):
                    across += R[k, rim] * (d_line[k, variable] - moves[k, variable])
            for k in range(3):
                d_ends[side, k, variable] = d_line[k, variable] - d[k] * across / slope
    return reaches, ends, d_ends


def _to_corners(state: State, pad: int, face: Flat, ranges: Array) -> list[Ray]:
    """Return the rays to the corners of a flat pad that lies on a flat face."""
    R, origin = frame(state, pad)
    (left, right), (low, high) = ranges
    local = np.array([[left, low, 0.0], [right, low, 0.0], [right, high, 0.0], [left, high, 0.0]])
    corners = local @ R.T + origin
    shared = clipped(Flat(corners, R[:, 2]), face)
    uncovered = face.room(corners).min(axis=1) < 0.0
    return [
        Ray(corner, moves(state, pad, corner), shared if beyond and len(shared) else None)
        for corner, beyond in zip(corners, uncovered, strict=True)
    ]


def _of_line(state: State, pad: int, face: ContactFace, patch: CylinderPatch) -> list[Ray]:
    """Return the two rays along the straight line of a round pad, where the object has one along it or is flat."""
    R, _ = frame(state, pad)
    d, c = R[:, 0], state.contacts.points[pad]
    if isinstance(face, Ruling):
        if float(np.linalg.norm(np.cross(face.direction, d))) > PARALLEL:
            return []
        ends = face.low, face.high
        covered = ends if face.direction @ d > 0.0 else (-ends[1], -ends[0])
    elif isinstance(face, Flat):
        covered = _within(face, c, d)
    else:
        return []
    first = state.model.robot.pads[pad].parameters.start
    size = state.model.robot.posture_size
    u, found = float(state.x[size + first]), []
    for limit, edge in zip(patch.u, covered, strict=True):
        t = limit - u
        d_end = moves(state, pad, c + t * d)
        d_end[:, size + first + 1] = state.contacts.d_points[pad][:, size + first + 1]
        found.append(Ray(c + t * d, d_end, None if abs(t) <= abs(edge) else (c + edge * d)[None]))
    return found


def _within(face: Flat, point: Array, direction: Array) -> tuple[float, float]:
    """Return from where to where a straight line through a point is over a flat face, m along it."""
    room, rates = face.room(point[None])[0], face.inward @ direction
    low = max((-r / s for r, s in zip(room, rates, strict=True) if s > 0.0), default=0.0)
    high = min((-r / s for r, s in zip(room, rates, strict=True) if s < 0.0), default=0.0)
    return min(low, 0.0), max(high, 0.0)
