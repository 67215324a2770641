"""Fields of classes as one list in the reference, inherited ones included, instead of a heading for each of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import griffe

_HIDDEN = {"model_config", "source", "digest", "format"}


class Fields(griffe.Extension):
    """Writes the attributes of every class into its docstring, and its properties that take no more than a paragraph.

    It comes after Griffe's own extension for dataclasses, which makes their signatures from what is taken away here.
    """

    def on_package(self, *, pkg: griffe.Module, loader: griffe.GriffeLoader, **_: Any) -> None:
        """Change all classes of a package; called when everything is loaded, so that bases are known."""
        del loader
        classes = list(_classes(pkg))
        lists = [(cls, _fields(cls)) for cls in classes]  # of all, before any of them loses its members
        meanings = {cls.name: _paragraph(cls) for cls in classes}
        for cls, attributes in lists:
            if attributes and cls.docstring:
                cls.docstring.parse("google")
                rows = [_row(attribute, meanings) for attribute in attributes.values()]
                cls.docstring.parsed.append(griffe.DocstringSectionAttributes(rows))
        for cls in classes:
            for name in [name for name, member in cls.members.items() if _is_listed(member) or _takes_anything(member)]:
                cls.del_member(name)


def _classes(parent: griffe.Module | griffe.Class) -> Iterator[griffe.Class]:
    for member in parent.members.values():
        if isinstance(member, griffe.Class):
            yield member
        if isinstance(member, griffe.Module | griffe.Class):
            yield from _classes(member)


def _fields(cls: griffe.Class) -> dict[str, griffe.Attribute]:
    """Return the public fields and short properties of a class by name, those of its bases first."""
    found: dict[str, griffe.Attribute] = {}
    for base in [*reversed(cls.mro()), cls]:
        found |= {name: member for name, member in base.members.items() if _is_listed(member)}
    return {name: attribute for name, attribute in found.items() if not _is_hidden(name, attribute)}


def _is_listed(member: Any) -> bool:
    if not isinstance(member, griffe.Attribute):
        return False
    return "property" not in member.labels or "\n\n" not in (member.docstring.value if member.docstring else "")


def _takes_anything(member: Any) -> bool:
    """Whether it is a constructor whose parameters say nothing, since it validates the fields."""
    return isinstance(member, griffe.Function) and [p.name for p in member.parameters] == ["self", "data"]


def _is_hidden(name: str, attribute: griffe.Attribute) -> bool:
    """Whether it is private, unexplained, or says something about the class and not about what is made of it."""
    of_class = attribute.labels & {"class-attribute", "instance-attribute"} == {"class-attribute"}
    unexplained = attribute.docstring is None and _is_assigned(attribute)
    return name[0] == "_" or name in _HIDDEN or attribute.annotation is None or of_class or unexplained


def _is_assigned(attribute: griffe.Attribute) -> bool:
    """Whether it gets its value in the constructor."""
    return "class-attribute" not in attribute.labels and attribute.value is not None


def _row(attribute: griffe.Attribute, meanings: dict[str, str]) -> griffe.DocstringAttribute:
    """Return an entry of the list; a field that says nothing is what its class is."""
    text = _paragraph(attribute) or meanings.get(str(attribute.annotation), "")
    value = "" if attribute.value is None or _is_assigned(attribute) else str(attribute.value)
    default = "" if value in ("", "None") or value.lower().startswith("field(") else value
    described = f"{text} Default: `{default}`." if default else text
    return griffe.DocstringAttribute(attribute.name, annotation=attribute.annotation, description=described.strip())


def _paragraph(documented: griffe.Attribute | griffe.Class) -> str:
    text = documented.docstring.value if documented.docstring else ""
    return " ".join(text.partition("\n\n")[0].split())
