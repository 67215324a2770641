"""Distances of a posture, pair by pair, where a certificate has only the least."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .certificate import PairClearance
from .clearance import (
    CAP,
    LinkPair,
    Placed,
    Surroundings,
    Walls,
    mesh_distance,
    part_distance,
    wall_bounds,
    wall_distance,
)
from .link_mesh import LinkMesh


def wall_clearances(meshes: Sequence[LinkMesh], walls: Walls, placed: Placed) -> Iterator[PairClearance]:
    """Yield the signed distances of links to walls that are below `CAP`."""
    for mesh, bounds in zip(meshes, wall_bounds(meshes, walls, placed), strict=True):
        for (wall, (inward, offset)), bound in zip(walls.items(), bounds, strict=True):
            if bound < CAP and (distance := wall_distance(mesh, inward, offset, placed)) < CAP:
                yield PairClearance("enclosure clearance", mesh.link, wall, distance)


def shape_clearances(name: str, around: Surroundings, placed: Placed) -> Iterator[PairClearance]:
    """Yield the signed distances of links to bodies of the scene that are below `CAP`."""
    least: dict[tuple[str, str], float] = {}
    for mesh, part in around.near(placed, CAP)[0]:
        pair = mesh.link, part.name
        least[pair] = min(least.get(pair, CAP), part_distance(mesh, part, placed, least.get(pair, CAP)))
    for (link, body), distance in least.items():
        if distance < CAP:
            yield PairClearance(name, link, body, distance)


def link_clearances(name: str, pairs: Sequence[LinkPair], placed: Placed) -> Iterator[PairClearance]:
    """Yield the distances of pairs of links that are below `CAP`."""
    for first, second in pairs:
        distance = mesh_distance(first, second, placed, CAP)
        if distance < CAP:
            yield PairClearance(name, first.link, second.link, distance)
