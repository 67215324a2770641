"""The signed distance of a truncated cone around the z axis; a cylinder is one whose radii are equal.

In the half-plane (rho, z) through the axis it is a trapezoid with the corners (r_1, -h/2) and (r_2, h/2). With the unit
normal n = (h, r_1 - r_2) / l of its slanted side, the depths below bottom, top and side are

    -z - h/2,    z - h/2,    n . (rho - r_1, z + h/2)

Inside, the distance is the largest of them; outside, it is that of the nearest side or corner. The gradient
(n_rho, n_z) lies in the half-plane; the Hessian is that of the trapezoid there, not zero only around a corner, plus
(n_rho / rho) t t^T along the tangent t of the circle.
"""

from __future__ import annotations

import math

import numpy as np

from ...arrays import Array
from ...compiled import compiled


@compiled
def frustum_distance(points: Array, bottom: float, top: float, half: float) -> tuple[Array, Array, Array]:
    """Return distance (n,), gradient (n, 3) and Hessian (n, 3, 3) at points (n, 3), m; on the axis, rho is along x.

    Args:
        points: in the frame of the cone.
        bottom: r_1, m.
        top: r_2, m.
        half: h / 2, m.
    """
    n = len(points)
    distances, gradients, hessians = np.empty(n), np.empty((n, 3)), np.empty((n, 3, 3))
    slant = math.hypot(2.0 * half, bottom - top)
    side_rho, side_z = 2.0 * half / slant, (bottom - top) / slant
    for i in range(n):
        x, y, z = points[i]
        rho = math.hypot(x, y)
        radial = (x / rho, y / rho, 0.0) if rho > 0.0 else (1.0, 0.0, 0.0)
        tangent = (-radial[1], radial[0], 0.0)
        below, above = -z - half, z - half
        beside = (rho - bottom) * side_rho + (z + half) * side_z
        along = (z + half) * side_rho - (rho - bottom) * side_z  # from the bottom's rim, up the side
        corner_rho, corner_z = 0.0, 0.0
        corner = False
        if below <= 0.0 and above <= 0.0 and beside <= 0.0:
            by_side = beside >= max(below, above)
        elif (below > 0.0 and rho <= bottom) or (above > 0.0 and rho <= top):
            by_side = False
        else:
            by_side = True
            if along < 0.0:
                corner, corner_rho, corner_z = True, rho - bottom, z + half
            elif along > slant:
                corner, corner_rho, corner_z = True, rho - top, z - half
        if corner:
            distances[i] = math.hypot(corner_rho, corner_z)
            n_rho, n_z = corner_rho / distances[i], corner_z / distances[i]
        elif by_side:
            distances[i], n_rho, n_z = beside, side_rho, side_z
        else:
            distances[i], n_rho, n_z = max(below, above), 0.0, 1.0 if above >= below else -1.0
        for j in range(3):
            gradients[i, j] = n_rho * radial[j]
        gradients[i, 2] = n_z
        around = n_rho / rho if rho > 0.0 else n_rho
        for j in range(3):
            for k in range(3):
                hessians[i, j, k] = around * tangent[j] * tangent[k]
                if corner:
                    axial = 1.0 if j == 2 and k == 2 else 0.0
                    plane = radial[j] * radial[k] + axial - gradients[i, j] * gradients[i, k]
                    hessians[i, j, k] += plane / distances[i]
    return distances, gradients, hessians
