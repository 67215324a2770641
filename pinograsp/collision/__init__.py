"""What may touch what, and how far apart: exact signed distances of convex solids with gradients."""
