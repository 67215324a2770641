"""Allowed collision pairs and clearances: exact signed distances of convex solids with gradients."""
