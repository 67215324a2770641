"""Independent pieces of work over processes."""
