"""Tagged unions that can be extended: the key `type` of a block says which class it is."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Union

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from .model import Frozen


class Kinds:
    """The classes that a block of a file may be, told apart by their key `type`.

    Stands in the annotation of a base class: `Annotated[Base, Kinds(First, Second)]`. The registry is asked whenever a
    file is read, so a class that is added is known at once to every model that uses it.

    A class that is added when its module is imported is known in worker processes too.
    """

    def __init__(self, *classes: type[Frozen]) -> None:
        self._set(classes)

    def __iter__(self) -> Iterator[type[Frozen]]:
        return iter(self._classes)

    def add(self, kind: type[Frozen]) -> None:
        """Add a class; its field `type` is a Literal that no other class has."""
        self._set((*self._classes, kind))

    def remove(self, kind: type[Frozen]) -> None:
        """Remove a class."""
        self._set(tuple(known for known in self._classes if known is not kind))

    def _set(self, classes: tuple[type[Frozen], ...]) -> None:
        union: Any = Union[classes]  # noqa: UP007 - made at run time
        self._union: TypeAdapter[Any] = TypeAdapter(Annotated[union, Field(discriminator="type")])
        self._classes = classes

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        # Without a serialisation of its own an instance is written by its own class.
        return core_schema.with_info_plain_validator_function(
            lambda value, info: self._union.validate_python(value, context=info.context)
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return handler(self._union.core_schema)
