"""Fields of classes as one table in the reference, inherited ones included, instead of a heading for each of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import griffe

_HIDDEN = {"model_config", "source", "digest", "format"}


class Fields(griffe.Extension):
    """Writes the attributes of every class into its docstring."""

    def on_package(self, *, pkg: griffe.Module, loader: griffe.GriffeLoader, **_: Any) -> None:
        """Change all classes of a package; called when everything is loaded, so that bases are known."""
        del loader
        classes = list(_classes(pkg))
        tables = [(cls, _fields(cls)) for cls in classes]  # of all, before any of them loses its members
        for cls, attributes in tables:
            if attributes and cls.docstring:
                cls.docstring.parse("google")
                rows = [_row(attribute) for attribute in attributes.values()]
                cls.docstring.parsed.append(griffe.DocstringSectionAttributes(rows))
        for cls in classes:
            for name in [name for name, member in cls.members.items() if _is_field(member)]:
                cls.del_member(name)


def _classes(parent: griffe.Module | griffe.Class) -> Iterator[griffe.Class]:
    for member in parent.members.values():
        if isinstance(member, griffe.Class):
            yield member
        if isinstance(member, griffe.Module | griffe.Class):
            yield from _classes(member)


def _fields(cls: griffe.Class) -> dict[str, griffe.Attribute]:
    """Return the public fields of a class by name, those of its bases first; properties are none."""
    found: dict[str, griffe.Attribute] = {}
    for base in [*reversed(cls.mro()), cls]:
        found |= {name: member for name, member in base.members.items() if _is_field(member)}
    return {name: attribute for name, attribute in found.items() if name not in _HIDDEN and name[0] != "_"}


def _is_field(member: Any) -> bool:
    return isinstance(member, griffe.Attribute) and "property" not in member.labels


def _row(attribute: griffe.Attribute) -> griffe.DocstringAttribute:
    text = attribute.docstring.value if attribute.docstring else ""
    value = str(attribute.value) if attribute.value is not None else ""
    default = "" if value in ("", "None") or value.startswith("Field(") or value.startswith("field(") else value
    described = f"{text} Default: `{default}`." if default else text
    return griffe.DocstringAttribute(attribute.name, annotation=attribute.annotation, description=described.strip())
