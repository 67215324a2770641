"""The start database: collision-free arm configurations of a robot in an enclosure, in one DuckDB file.

Section 3.5 and Algorithm 1 of the paper: the workspace is sampled once, and every plan takes its starts from a query
for the wrist near the object. `identity` says what a database belongs to, `store` is the file, `build` fills
it, `query` reads regions and spreads starts, `coverage` counts what the wrist reaches, `cache` keeps small ones.
"""
