"""Contact on a mesh: what the search and the verification both mean by the normal that a pad feels.

A rubber pad feels the mean of what is below it, not the facet at one point. Its footprint normal is the gradient of the
signed distance convolved with an isotropic Gaussian of standard deviation sigma, normalised. On a plate of thickness t
the smoothed distance still has a slope of erf(t / (2 sqrt(2) sigma)) on its surface, 0.68 for t = 2 sigma; where a body
is thinner, opposite sides begin to cancel. So sigma is the first of `SIGMAS` for which the body is thicker than 2 sigma
over at least `THICK_SHARE` of its area; the last one if it is so for none.

With c the centroid of a face and n its outward normal, the body is thicker than 2 sigma there if both c - sigma n and
c - 2 sigma n are inside by the winding number. Of a mesh with more than `FACES` faces, every k-th is asked,
k = ceil(number of faces / FACES).

Rubber evens out a tilt of a pad against the footprint normal, but a pad that lies on a surface is never tilted by more
than `LARGEST_TILT`, however narrow it is.
"""

from __future__ import annotations

import math

SIGMAS = (0.002, 0.0015, 0.001, 0.0005)
"""Standard deviations of the Gaussian, m; the first is half the width of what a pad's footprint covers."""
THICK_SHARE = 0.9
FACES = 20_000
LARGEST_TILT = math.radians(5.0)
"""Of a pad against the footprint normal, in any direction, rad."""
TURN = math.radians(0.5)
"""By which two ways to the footprint normal may differ, rad."""
