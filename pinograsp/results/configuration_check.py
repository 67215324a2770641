"""The outcome of checking a configuration that the user gives."""

from __future__ import annotations

from dataclasses import dataclass

from ..frozen import Record
from ..verification.certificate import Certificate, PairClearance
from .grasp import Grasp


@dataclass(frozen=True, eq=False, repr=False)
class ConfigurationCheck(Record):
    """A configuration of the user's, as the independent check has it; `visualization` draws it like a grasp."""

    also_in_json = ("verified",)

    grasp: Grasp
    """The configuration with the contacts where the pads are nearest to touching, and the best forces there; verified
    or not, it knows robot, scene and task. Its `start` is None, its `count` 0."""
    clearances: tuple[PairClearance, ...]
    """Distances below 50 mm, pair by pair, the least first."""
    warnings: tuple[str, ...] = ()
    """Oddities of poses, and what was guessed and mended in mesh files, as a plan warns of it."""

    @property
    def certificate(self) -> Certificate:
        """Every figure of the check: the certificate of the grasp."""
        return self.grasp.certificate

    @property
    def verified(self) -> bool:
        """Whether the configuration is a grasp: every figure keeps its limit."""
        return self.certificate.verified

    def __repr__(self) -> str:
        return f"<ConfigurationCheck: {self.certificate!r}, {len(self.clearances)} pairs nearer than 50 mm>"

    def _repr_html_(self) -> str:
        from .html import check_html  # as `Grasp` does

        return check_html(self)
