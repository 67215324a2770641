"""The pads of a robot in its Pinocchio model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from ..arrays import Array, Indices
from ..descriptions.hand import PadDescription
from ..descriptions.patches import Patch


@dataclass(frozen=True)
class Pad:
    """A pad in the model: patch frame in its joint's frame, x and y along the contact parameters, z outward."""

    description: PadDescription
    joint: int
    rotation: Array
    """Shape (3, 3)."""
    translation: Array
    """m, shape (3,)."""
    parameters: slice
    """Where its contact parameters are in q_c."""

    @property
    def patch(self) -> Patch:
        """The surface."""
        return self.description.patch


class PadFrames(NamedTuple):
    """The frames of all pads as arrays."""

    joints: Indices
    """Shape (n,)."""
    rotations: Array
    """Shape (n, 3, 3)."""
    translations: Array
    """m, shape (n, 3)."""
    owners: Indices
    """Pad of every contact parameter, shape (c,)."""

    @classmethod
    def of(cls, pads: Sequence[Pad]) -> PadFrames:
        """Return the frames of pads."""
        return cls(
            np.array([pad.joint for pad in pads]),
            np.array([pad.rotation for pad in pads]),
            np.array([pad.translation for pad in pads]),
            np.array([number for number, pad in enumerate(pads) for _ in pad.patch.parameters]),
        )


def pads_of(model: Any, pads: Sequence[PadDescription]) -> tuple[Pad, ...]:
    """Return described pads in a Pinocchio model; their contact parameters follow each other."""
    found, first = list[Pad](), 0
    for pad in pads:
        frame = model.frames[model.getFrameId(pad.link, pin.BODY)]
        placement = frame.placement * pin.SE3(pad.patch.rotation, np.array(pad.patch.origin))
        parameters = slice(first, first + len(pad.patch.parameters))
        found.append(Pad(pad, frame.parentJoint, placement.rotation.copy(), placement.translation.copy(), parameters))
        first = parameters.stop
    return tuple(found)
