"""Addresses of files as URDFs have them, and the folders of the packages that they name.

    package://name/rest    model://name/rest    $(find name)/rest    $(find-pkg-share name)/rest
    file:///path           file://localhost/path                     path

The folder of a package is the one that is given for its name, or one of its name in a listed folder, or one below it
whose `package.xml` has the name. An address that leads to no file is tried with `%20` as a space, and with backslashes
as slashes.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote

from ..disk import is_file, is_folder, is_there

SCHEMES = ("package://", "model://")
_FIND = re.compile(r"\$\(\s*(?:find|find-pkg-share)\s+([^)\s]+)\s*\)[/\\]?(.*)", re.DOTALL)
_NAMED = re.compile(r"([A-Za-z0-9][A-Za-z0-9_.-]*)=(.+)", re.DOTALL)
_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_NAME = re.compile(rb"<name>\s*([^<\s]+)\s*</name>")
_DEPTH = 3
"""Folders below a listed one, one in the other, in which a `package.xml` is looked for."""
_MOST_FOLDERS = 2000
_MOST_BYTES = 100_000


class Address(NamedTuple):
    """One reading of an address."""

    package: str | None
    """Name of a package; None: a path, from the file that holds the address if it is relative."""
    path: str
    """In the package, or by itself."""


def readings(text: str) -> list[Address]:
    """Return what an address may mean, the likeliest first."""
    texts = [text, unquote(text), text.replace("\\", "/"), unquote(text).replace("\\", "/")]
    return list(dict.fromkeys(map(_read, texts)))


def _read(text: str) -> Address:
    for scheme in SCHEMES:
        if text.startswith(scheme):
            name, _, rest = text.removeprefix(scheme).partition("/")
            return Address(name, rest.lstrip("/"))
    if text.startswith("file:"):
        text = text.removeprefix("file://").removeprefix("localhost").removeprefix("file:")
    found = _FIND.fullmatch(text)
    if found is not None:
        return Address(found[1], found[2])
    return Address(None, str(expanded(text)) if text.startswith("~") else text)


def expanded(path: str | Path) -> Path:
    """Return a path with ~ replaced as shells do; one of an unknown user stays as it is, and is not found."""
    try:
        return Path(path).expanduser()
    except RuntimeError:
        return Path(path)


def named_folder(entry: str | Path) -> tuple[str | None, Path]:
    """Return the package, if one is named, and the folder of an entry such as `name=folder` or `folder`."""
    found = _NAMED.fullmatch(str(entry))
    return (None, Path(entry)) if found is None else (found[1], Path(found[2]))


def absolute_entry(entry: str | Path) -> Path:
    """Return such an entry with its folder as an absolute path."""
    name, folder = named_folder(entry)
    absolute = expanded(folder).resolve()
    return absolute if name is None else Path(f"{name}={absolute}")


class PackageFolders:
    """Folders in which packages are looked up.

    Args:
        entries: folders, or `name=folder` for the folder of one package.
        beside: folder from which relative ones start.
        others: further folders.
    """

    def __init__(self, entries: Sequence[str | Path], beside: Path, others: Sequence[Path] = ()) -> None:
        given = [(name, (beside / expanded(folder)).resolve()) for name, folder in map(named_folder, entries)]
        self.named = {name: folder for name, folder in given if name is not None}
        self.listed = [*(folder for name, folder in given if name is None), *others]

    @property
    def all(self) -> list[Path]:
        """All of them: nothing outside is read."""
        return [*self.named.values(), *self.listed]

    def of(self, package: str) -> Iterator[Path]:
        """Yield folders that a package may have, the likeliest first."""
        if package in self.named:
            yield self.named[package]
            return
        yield from (folder / package for folder in self.listed)
        yield from self._by_package_xml.get(package, [])

    @cached_property
    def _by_package_xml(self) -> dict[str, list[Path]]:
        found: dict[str, list[Path]] = {}
        for listed in self.listed:
            for folder in _below(listed):
                if (name := package_name(folder)) is not None:
                    found.setdefault(name, []).append(folder)
        return found


def package_name(folder: Path) -> str | None:
    """Return the name of the package in a folder by its `package.xml`; None without one."""
    with suppress(OSError):
        with (folder / "package.xml").open("rb") as file:
            found = _NAME.search(_COMMENT.sub(b"", file.read(_MOST_BYTES)))
        return None if found is None else found[1].decode("utf-8", "replace")
    return None


def _below(folder: Path) -> list[Path]:
    """Return a folder and those below it, nearest first, not all of a large tree."""
    found = level = [folder]
    for _ in range(_DEPTH):
        level = [inner for outer in level for inner in folders_in(outer)][: _MOST_FOLDERS - len(found)]
        found = [*found, *level]
    return found


def folders_in(folder: Path) -> list[Path]:
    """Return the folders directly in a folder that are not hidden, sorted; none of one that cannot be read."""
    with suppress(OSError):
        return sorted(inner for inner in folder.iterdir() if not inner.name.startswith(".") and is_folder(inner))
    return []


def candidates(address: str, home: Path, folders: PackageFolders) -> Iterator[Path]:
    """Yield the files that an address may mean, the likeliest first.

    Args:
        address: as written.
        home: folder of the file that holds it.
        folders: of packages.
    """
    for package, path in readings(address):
        if package is None:
            yield home / path
        else:
            yield from (folder / path for folder in folders.of(package))


def remedy_for(address: str, home: Path, folders: PackageFolders) -> str:
    """Return what is to be done about an address that leads to no file; arguments as of `candidates`."""
    allowed = [folder.resolve() for folder in (home, *folders.all)]
    for candidate in candidates(address, home, folders):
        other = _in_other_case(Path(os.path.normpath(candidate)))
        if other is not None and any(other.resolve().is_relative_to(folder) for folder in allowed):
            return f"There is {other}: upper and lower case count"
    looked = ", ".join(dict.fromkeys(map(os.path.normpath, [home, *folders.all])))
    package = readings(address)[0].package
    if package is None:
        return f"Looked in {looked}; name further folders under `packages` in the robot file"
    there = next((folder for folder in folders.of(package) if is_folder(folder)), None)
    if there is not None:
        return f"The package is taken to be {there}; if another is meant, give its folder: {_how_to_give(package)}"
    return f"Looked for package {package} in {looked}; give its folder: {_how_to_give(package)}"


def _how_to_give(package: str) -> str:
    return f"`packages: [{package}=FOLDER]` in the robot file, or --packages {package}=FOLDER"


def _in_other_case(path: Path) -> Path | None:
    """Return the file that has a path but for upper and lower case."""
    found = Path(path.anchor)
    for part in path.parts[1:]:
        inner = found / part
        if not is_there(inner):
            with suppress(OSError):
                alike = sorted(entry for entry in found.iterdir() if entry.name.lower() == part.lower())
                inner = alike[0] if alike else inner
        found = inner
    return found if is_file(found) else None
