"""Robots that pinograsp does not know yet: a first robot file for a URDF, and a check of any robot file."""
