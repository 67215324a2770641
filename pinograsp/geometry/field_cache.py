"""Distance fields of meshes, kept in the user's cache folder."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..array_cache import kept
from ..disk import digest
from .distance_field import VERSION, DistanceField, distance_field, footprint_sigma
from .exact_distance import ExactDistance
from .lattice import Lattice

LATTICES = ("distance", "smoothed", "coarse")


def mesh_field(name: str, exact: ExactDistance) -> DistanceField:
    """Return the fields of a closed mesh, with the Gaussian that its thickness allows.

    Args:
        name: of the file in the cache, besides the digest of the content.
        exact: distances to the mesh.
    """
    arrays = exact.vertices, exact.faces, exact.bounding
    key = digest(f"{VERSION} {[len(part) for part in arrays]} ".encode() + b"".join(part.tobytes() for part in arrays))

    def make() -> DistanceField:
        return distance_field(exact, footprint_sigma(exact))

    return kept("fields", f"{name}-{key[:32]}", make, _arrays_of, _field_of)


def _arrays_of(field: DistanceField) -> dict[str, Any]:
    arrays: dict[str, Any] = {"above": field.above, "error": field.error}
    for name, lattice in zip(LATTICES, (field.distance, field.smoothed, field.coarse), strict=True):
        arrays |= {
            name: lattice.coefficients,
            f"{name}_origin": lattice.origin,
            f"{name}_spacing": lattice.spacing,
        }
    return arrays


def _field_of(arrays: Mapping[str, Any]) -> DistanceField:
    distance, smoothed, coarse = (
        Lattice(arrays[name], arrays[f"{name}_origin"], float(arrays[f"{name}_spacing"])) for name in LATTICES
    )
    return DistanceField(distance, smoothed, coarse, arrays["above"], float(arrays["error"]))
