"""Starts and local solves: where to begin, projection on the contacts, solvers behind one interface."""
