"""Geometry without robots: surfaces of shapes, patches, regions, hulls, convex covers of meshes."""
