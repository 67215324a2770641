"""XML trees of URDFs and SRDFs: read, asked, and cut."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from xml.parsers import expat

from ..disk import content_of
from ..errors import FileError


def parse(file: Path, tag: str) -> ET.Element:
    """Read an XML file whose root element is `tag`.

    Raises:
        FileError: it cannot be read, is no XML, or has another root element.
    """
    try:
        root = _read(content_of(file))
    except (ET.ParseError, expat.ExpatError, ValueError, LookupError) as error:  # the last two of unknown encodings
        raise FileError(f"is not valid XML: {error}", file=file) from None
    if root.tag != tag:
        raise FileError(f"holds <{root.tag}>, not <{tag}>", file=file, remedy="If it is xacro, run xacro first")
    return root


def _read(content: bytes) -> ET.Element:
    """Return the root element; where a prefix stands for nothing, names with a prefix keep it, with their colon.

    Blank lines before the declaration, which other readers of URDFs skip, are skipped.
    """
    if (begun := content.lstrip()).startswith(b"<?xml"):
        content = begun
    try:
        return ET.fromstring(content)
    except ET.ParseError as error:
        if error.code != expat.errors.codes[expat.errors.XML_ERROR_UNBOUND_PREFIX]:
            raise
    builder, parser = ET.TreeBuilder(), expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = builder.start, builder.end
    parser.CharacterDataHandler = builder.data
    parser.Parse(content, True)
    return builder.close()


def names_of(tree: ET.Element, tag: str) -> list[str]:
    """Return the names of the elements of a kind, in their order; empty where there is none."""
    return [element.get("name", "") for element in tree.findall(tag)]


def ends(joint: ET.Element) -> tuple[str, str]:
    """Return the links that a joint joins: parent and child."""
    return end_of(joint, "parent"), end_of(joint, "child")


def end_of(joint: ET.Element, end: str) -> str:
    """Return the link at one end of a joint, "parent" or "child"; empty where there is none."""
    found = joint.find(end)
    return "" if found is None else found.get("link", "")


def root_of(tree: ET.Element) -> str:
    """Return the link that no joint carries."""
    children = {end_of(joint, "child") for joint in tree.findall("joint")}
    return next(name for name in names_of(tree, "link") if name not in children)


def carried(tree: ET.Element, link: str) -> set[str]:
    """Return a link and all that it carries."""
    found, frontier = {link}, {link}
    while frontier:
        frontier = {end_of(joint, "child") for joint in tree.findall("joint") if end_of(joint, "parent") in frontier}
        found |= frontier
    return found


def keep_links(tree: ET.Element, links: set[str], *, keep: bool) -> None:
    """Remove the links that are not among `links` (or, if not `keep`, those that are), and their joints."""
    for link in tree.findall("link"):
        if (link.get("name") in links) != keep:
            tree.remove(link)
    left = set(names_of(tree, "link"))
    for joint in tree.findall("joint"):
        if not set(ends(joint)) <= left:
            tree.remove(joint)


def put_prefix(tree: ET.Element, prefix: str, key: str) -> None:
    """Put a prefix before every name of links and joints, and mark materials as those of the part `key`."""
    for element in tree.iter():
        if element.tag == "material" and element.get("name"):
            element.set("name", f"{element.get('name')} ({key})")
        for key in ("link", "joint") if element.tag in {"parent", "child", "mimic"} else ():
            if element.get(key) is not None:
                element.set(key, prefix + element.get(key, ""))
    for element in [*tree.findall("link"), *tree.findall("joint")]:
        element.set("name", prefix + element.get("name", ""))
