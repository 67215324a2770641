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

    def besides(self, name: str) -> _Besides:
        """Return what stands in the annotation of a part of the kind of this name: the schema lists the others.

        Of every kind, that one too, an instance is made: who annotates refuses it in words of its own.
        """
        return _Besides(self, name)

    def _set(self, classes: tuple[type[Frozen], ...]) -> None:
        self._union = _union(classes)
        self._classes = classes

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        # Without a serialisation of its own an instance is written by its own class.
        return core_schema.with_info_plain_validator_function(
            lambda value, info: self._union.validate_python(value, context=info.context)
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return handler(self._union.core_schema)


class _Besides:
    """The kinds of a registry, of which the JSON Schema leaves one out: it would go round in circles."""

    def __init__(self, kinds: Kinds, name: str) -> None:
        self._kinds, self._name = kinds, name

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return self._kinds.__get_pydantic_core_schema__(source, handler)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        others = tuple(kind for kind in self._kinds if kind.model_fields["type"].default != self._name)
        return handler(_union(others).core_schema)


def _union(classes: tuple[type[Frozen], ...]) -> TypeAdapter[Any]:
    union: Any = Union[classes]  # noqa: UP007 - made at run time
    return TypeAdapter(Annotated[union, Field(discriminator="type")])
