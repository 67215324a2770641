"""Normal of a contact on a mesh: the definition that problem and verification share, and nothing else of it.

A facet's normal changes from triangle to triangle; a rubber pad feels the mean over its footprint. The footprint normal
at p is the gradient of the signed distance convolved with an isotropic Gaussian of standard deviation sigma, normalised.
sigma is one number a mesh, with V its volume (triangles from the middle of its bounding box) and A its area:

    sigma = min(FOOTPRINT_SIGMA, max(LEAST_SIGMA, V / A))

A plate of thickness t has V / A = t / 2: the smoothed distance still rises across its surface. A ball has r / 3.
"""

FOOTPRINT_SIGMA = 0.002
"""Half the width of the footprint of rubber under the forces of a gripper, m."""
LEAST_SIGMA = 0.0005
"""Of thin sheets, m."""
