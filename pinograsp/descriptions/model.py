"""Base of what robot and scene files say: validated, immutable parts, made from files or in Python."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from .problems import input_error


class Frozen(BaseModel):
    """A part of a file, or of what is made in Python: immutable; a key that it does not know is an error.

    Raises:
        InputError: (where one is made in Python) a value is wrong; the message names the key.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)  # what is never made costs nothing

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise input_error(error, type(self), data) from None

    # So pydantic does not call it for the parts of a whole, whose errors then name the path from the whole.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    def __eq__(self, other: object) -> bool:
        """Whether another one of the same class says the same; what was computed from the fields does not count."""
        if not isinstance(other, Frozen) or type(other) is not type(self):
            return NotImplemented
        return self.fields() == other.fields()

    def fields(self) -> dict[str, Any]:
        """Return the values of the fields by name, without what was computed from them."""
        return {name: getattr(self, name) for name in type(self).model_fields}

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with some fields changed, which are not validated; what was computed is not copied."""
        copied = super().model_copy(update=update, deep=deep)
        for name in set(copied.__dict__) - set(type(copied).model_fields):
            del copied.__dict__[name]
        return copied


class FileRoot(Frozen):
    """The whole of a file."""

    format: int
    source: Path | None
    """Where it was read from."""
    digest: str
    """SHA-256 of the bytes of that file, in hexadecimal."""


Root = TypeVar("Root", bound=FileRoot)
