"""A tree of balls: which of many balls come near to some boxes, without looking at all of them.

Each node is a ball around the balls of its members. Nodes are stored in the order in which a search comes by, and every
one knows the first node beyond it, to go on with where its ball is too far. Members keep their numbers, and a node
never hides a member that is near: the tree changes how long a search takes, and nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled

LEAF = 4
"""Members at most of a node that is not divided further."""
SLACK = 1e-9
"""What rounding may take from the ball of a node, m."""


@dataclass(frozen=True)
class BallTree:
    """Balls and the nodes above them."""

    centers: Array
    """Of the members, m, shape (n, 3)."""
    radii: Array
    """m, shape (n,)."""
    order: Indices
    """Members in the order of the leaves, shape (n,)."""
    ranges: Indices
    """Of every node: first and last but one of its members in this order, and the node to go on with, (nodes, 3)."""
    balls: Array
    """Centre and radius of every node, m, shape (nodes, 4)."""

    @classmethod
    def of(cls, centers: Array, radii: Array) -> BallTree:
        """Return the tree of balls: centers (n, 3) and radii (n,), m."""
        order, ranges = np.arange(len(radii)), list[list[int]]()

        def divide(begin: int, end: int) -> None:
            ranges.append([begin, end, 0])
            node = len(ranges) - 1
            if end - begin > LEAF:
                members = order[begin:end]
                axis = int(np.ptp(centers[members], axis=0).argmax())
                order[begin:end] = members[np.argsort(centers[members, axis], kind="stable")]
                middle = (begin + end) // 2
                divide(begin, middle)
                divide(middle, end)
            ranges[node][2] = len(ranges)

        if len(radii):
            divide(0, len(radii))
        nodes = np.array(ranges, dtype=np.intp).reshape(-1, 3)
        return cls(centers, radii, order, nodes, _balls(order, nodes, centers, radii))

    def moved(self, centers: Array) -> BallTree:
        """Return the tree of the same balls at other centers, m, shape (n, 3)."""
        balls = _balls(self.order, self.ranges, centers, self.radii)
        return BallTree(centers, self.radii, self.order, self.ranges, balls)

    def near(self, rotations: Array, points: Array, halves: Array, reaches: Array) -> tuple[Indices, Indices]:
        """Return the pairs of a box and a ball that are nearer to each other than the box's reach.

        Args:
            rotations: of the boxes, their edges as columns, shape (k, 3, 3).
            points: their centres, m, shape (k, 3).
            halves: half their edges, m, shape (k, 3).
            reaches: of the boxes, m, shape (k,).

        Returns:
            Numbers of the boxes, ascending, and of the members; both of shape (pairs,).
        """
        return _near(rotations, points, halves, reaches, self.centers, self.radii, self.order, self.ranges, self.balls)


@compiled
def _balls(order: Indices, ranges: Indices, centers: Array, radii: Array) -> Array:
    balls = np.empty((len(ranges), 4))
    for node in range(len(ranges)):
        begin, end = ranges[node, 0], ranges[node, 1]
        for axis in range(3):
            low, high = np.inf, -np.inf
            for k in range(begin, end):
                low = min(low, centers[order[k], axis] - radii[order[k]])
                high = max(high, centers[order[k], axis] + radii[order[k]])
            balls[node, axis] = 0.5 * (low + high)
        balls[node, 3] = 0.0
        for k in range(begin, end):
            square = 0.0
            for axis in range(3):
                square += (centers[order[k], axis] - balls[node, axis]) ** 2
            balls[node, 3] = max(balls[node, 3], np.sqrt(square) + radii[order[k]] + SLACK)
    return balls


@compiled
def _near(
    rotations: Array,
    points: Array,
    halves: Array,
    reaches: Array,
    centers: Array,
    radii: Array,
    order: Indices,
    ranges: Indices,
    balls: Array,
) -> tuple[Indices, Indices]:
    rows, members, count = np.empty(64, dtype=np.intp), np.empty(64, dtype=np.intp), 0
    for row in range(len(points)):
        R, point, half, reach = rotations[row], points[row], halves[row], reaches[row]
        node = 0
        while node < len(ranges):
            ball = balls[node]
            if not _touches(R, point, half, ball[0], ball[1], ball[2], reach + ball[3]):
                node = ranges[node, 2]
                continue
            if ranges[node, 2] == node + 1:
                for k in range(ranges[node, 0], ranges[node, 1]):
                    member = order[k]
                    x, y, z = centers[member]
                    if _touches(R, point, half, x, y, z, reach + radii[member] + SLACK):
                        if count == len(rows):
                            rows = np.concatenate((rows, np.empty_like(rows)))
                            members = np.concatenate((members, np.empty_like(members)))
                        rows[count], members[count] = row, member
                        count += 1
            node += 1
    return rows[:count].copy(), members[:count].copy()


@compiled
def _touches(R: Array, point: Array, half: Array, x: float, y: float, z: float, reach: float) -> bool:
    """Whether a point is nearer than `reach` to a box."""
    if reach <= 0.0:
        return False
    square, u, v, w = 0.0, x - point[0], y - point[1], z - point[2]
    for k in range(3):
        beyond = abs(R[0, k] * u + R[1, k] * v + R[2, k] * w) - half[k]
        if beyond > 0.0:
            square += beyond * beyond
    return square < reach * reach
