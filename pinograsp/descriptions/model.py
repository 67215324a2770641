"""Base of what robot and scene files say: validated, immutable parts, made from files or in Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import FrozenInstanceError
from typing import TYPE_CHECKING, Any, Self, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from ..interrupts import held
from .problems import input_error, refuse_internal
from .values import FilePath


class Frozen(BaseModel):
    """A part of a file, or of what is made in Python: immutable; a key that it does not know is an error.

    Raises:
        InputError: (where one is made in Python) a value is wrong; the message names the key.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)  # what is never made costs nothing

    def __init__(self, /, **data: Any) -> None:
        fields = type(self).model_fields
        refuse_internal([name for name in data if name in fields and fields[name].init is False])
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise input_error(error, type(self), data) from None

    # So pydantic does not call it for the parts of a whole, whose errors then name the path from the whole.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    @classmethod
    def _made(cls, content: Mapping[str, Any]) -> Self:
        """Return what a file of this content would give.

        Raises:
            InputError: a key is unknown or missing, or a value is wrong; the message names the key.
        """
        try:
            with held():  # pydantic would take an interrupt for an error in the content
                return cls.model_validate(content)
        except ValidationError as error:
            raise input_error(error, cls, content) from None

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return the same with some fields replaced, validated as a file is.

        Args:
            update: values by field.
            deep: makes no difference: what cannot be changed is its own copy.

        Raises:
            InputError: a field is unknown, or a value is wrong; the message names the key.
        """
        del deep
        return self._made({**self.fields(), **update}) if update else self

    if not TYPE_CHECKING:  # else any attribute could be set, for type checkers

        def __setattr__(self, name: str, value: object) -> None:
            """Refuse to change anything."""
            raise self._cannot_change(name)

        def __delattr__(self, name: str) -> None:
            """Refuse to remove anything."""
            raise self._cannot_change(name)

    def _cannot_change(self, name: str) -> FrozenInstanceError:
        """Return the error of who tries, of the class that results raise, too."""
        how = f"make another one with model_copy(update={{{name!r}: ...}})"
        return FrozenInstanceError(f"{type(self).__name__} cannot be changed: {how}")

    def __eq__(self, other: object) -> bool:
        """Whether another one of the same class says the same; what was computed from the fields does not count."""
        if not isinstance(other, Frozen) or type(other) is not type(self):
            return NotImplemented
        return self.fields() == other.fields()

    def fields(self) -> dict[str, Any]:
        """Return the values of the fields by name, without what was computed from them."""
        return {name: getattr(self, name) for name in type(self).model_fields}

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        return self

    def __getstate__(self) -> dict[Any, Any]:
        # Not what was computed from the fields: arrays would come back writable.
        return {**super().__getstate__(), "__dict__": self.fields()}


class FileRoot(Frozen):
    """The whole of a file."""

    format: int
    source: FilePath | None
    """Where it was read from."""
    digest: str
    """SHA-256 of the bytes of that file, in hexadecimal."""


Root = TypeVar("Root", bound=FileRoot)
