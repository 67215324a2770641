"""Distribution of the samples of a database."""

from typing import Literal

Spread = Literal["joints", "wrist"]
"""Uniform over the joint angles, or as even as possible over the wrist's positions."""
