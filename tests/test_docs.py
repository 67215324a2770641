"""The documentation is whole: every page is found, every link leads somewhere, every public name and file is named."""

from __future__ import annotations

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from test_readme import blocks

import pinograsp
from pinograsp import ApproachCone, Body, Claim, Robot, Scene, Sphere, Verifier
from pinograsp.problem import TaskModel

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
CONFIGURATION = yaml.load((ROOT / "mkdocs.yml").read_text(), Loader=yaml.BaseLoader)
DEFAULTS = {"margin", "reserve", "force_weight"}
"""Keys of a task whose defaults a page shows."""
RECIPES = (ROOT / "CONTRIBUTING.md").read_text()
TEXTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *PAGES]


def listed(nav: Any) -> list[str]:
    """Return the pages of a navigation."""
    if isinstance(nav, str):
        return [nav]
    parts = nav.values() if isinstance(nav, dict) else nav
    return [page for part in parts for page in listed(part)]


def without_code(text: str) -> str:
    """Return Markdown without its code."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^ *```.*?^ *```$", "", text, flags=re.MULTILINE | re.DOTALL))


def test_the_navigation_has_every_page_once() -> None:
    pages = listed(CONFIGURATION["nav"])
    assert sorted(pages) == sorted(str(page.relative_to(DOCS)) for page in PAGES)


@pytest.mark.parametrize("file", TEXTS, ids=lambda file: str(file.relative_to(ROOT)))
def test_links_lead_to_files(file: Path) -> None:
    targets = re.findall(r"\]\(([^)#\s]+)(?:#[\w-]+)?\)", without_code(file.read_text()))
    for target in targets:
        assert target.startswith("https://") or (file.parent / target).exists(), target


def test_the_reference_has_every_public_name_and_no_other() -> None:
    shown = re.findall(r"^::: pinograsp\.([\w.]+)$", "\n".join(page.read_text() for page in PAGES), re.MULTILINE)
    assert len(shown) == len(set(shown))
    submodule = {name for name in shown if name.startswith("visualization.")}
    assert submodule == {f"visualization.{name}" for name in pinograsp.visualization.__all__}
    assert set(shown) - submodule == set(pinograsp.__all__) - {"visualization", "__version__"}
    index = (DOCS / "reference" / "index.md").read_text()
    for name in shown:
        assert f"[`{name}`][pinograsp.{name}]" in index


def test_the_tree_of_errors_is_drawn_as_it_is() -> None:
    page = (DOCS / "reference" / "errors.md").read_text()
    drawn = re.findall(r"^( *)(\w+Error)\b", page.partition("```text\n")[2].partition("```")[0], re.MULTILINE)
    above: list[str] = []
    for indentation, name in drawn:
        above = [*above[: len(indentation) // 4], name]
        assert getattr(pinograsp, name).__base__.__name__ == (above[-2] if len(above) > 1 else "Exception")
    assert {name for _, name in drawn} == {name for name in pinograsp.__all__ if name.endswith("Error")}


@pytest.mark.parametrize(
    "block", [text for page in ("tasks", "locked_joint") for text in blocks(DOCS / "howto" / f"{page}.md", "yaml")]
)
def test_keys_of_a_task_are_understood(block: str) -> None:
    keys = yaml.safe_load(block)
    scene = pinograsp.load_scene("glovebox_can")
    changed = scene.with_task("can", **keys)
    assert TaskModel(pinograsp.load_robot("gen3_2f85"), changed, "can")
    assert all(
        getattr(changed.task("can"), key) != getattr(scene.task("can"), key) for key in keys if key not in DEFAULTS
    )


def test_defaults_of_a_task_are_what_the_page_says() -> None:
    shown = next(yaml.safe_load(text) for text in blocks(DOCS / "howto" / "tasks.md", "yaml") if "margin" in text)
    task = pinograsp.load_scene("panda_table").task("sphere").model_dump()
    for key in DEFAULTS:
        assert shown[key] == task[key]


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text().splitlines()) <= 120


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`(test_\w+)`", RECIPES))))
def test_tests_of_the_recipes_exist(name: str) -> None:
    found = [file.name for file in (ROOT / "tests").glob("*.py") if f"def {name}(" in file.read_text()]
    assert len(found) == 1
    section = next(part for part in re.split(r"^### ", RECIPES, flags=re.MULTILINE) if f"`{name}`" in part)
    assert f"`tests/{found[0]}`" in section


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`([A-Z]{4,})`", RECIPES))))
def test_registries_of_the_recipes_exist(name: str) -> None:
    files = [*(ROOT / "pinograsp").rglob("*.py"), *(ROOT / "tests").glob("*.py")]
    assert any(re.search(rf"^{name}\b.* = ", file.read_text(), flags=re.MULTILINE) for file in files)


def test_every_example_is_on_a_page() -> None:
    pages = "\n".join(page.read_text() for page in PAGES)
    for example in (DOCS / "examples").iterdir():
        assert f"docs/examples/{example.name}" in pages


def figures_of(robot: Robot, scene: Scene, task: str) -> set[str]:
    """Return the names of the figures of a certificate, of whatever claim."""
    points = np.array(scene.task(task).desired_contacts)
    joints = dict.fromkeys(robot.joint_names, 0.0)
    claim = Claim(joints, points, forces=np.ones_like(points), spin_torques=np.zeros(len(points)))
    return {figure.name for figure in Verifier(robot.description, scene, task).certify(claim).figures}


def test_documented_figures_are_those_of_certificates(gen3: Robot) -> None:
    """Names in the table of what is verified, against those of a task that asks for everything, and of synergies."""
    table = (DOCS / "verified.md").read_text().partition("| figure |")[2].partition("\n\n")[0]
    shown = [name for row in re.findall(r"^\| ([^|]+) \|", table, re.MULTILINE) for name in row.split(", ")]
    scene = pinograsp.load_scene("glovebox_can").with_obstacle("post", Body(shape=Sphere(radius=0.01)))
    approach = ApproachCone(direction=(0.0, 0.0, -1.0), angle=1.0)
    scene = scene.with_task("can_region", approach=approach, lock={"joint_7": 0.0}, withstand=1.0)
    made = figures_of(gen3, scene, "can_region")
    made |= figures_of(pinograsp.load_robot("xarm7_allegro"), pinograsp.load_scene("allegro_ceiling"), "can")
    assert sorted(set(shown) - {"---"}) == sorted(made)


class Fetched(HTMLParser):
    """What a page loads when it is opened."""

    def __init__(self) -> None:
        super().__init__()
        self.addresses: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        given = dict(attributes)
        if tag in {"script", "img", "iframe", "source"} and given.get("src"):
            self.addresses.append(str(given["src"]))
        if tag == "link" and given.get("rel") in {"stylesheet", "icon", "preload", "preconnect", "prefetch"}:
            self.addresses.append(str(given["href"]))


def test_the_site_is_built_without_warnings_and_loads_nothing_from_elsewhere(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path / "site")]
    environment = {"NO_MKDOCS_2_WARNING": "1", "PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    pages = list((tmp_path / "site").rglob("*.html"))
    assert len(pages) > len(PAGES)  # and the one for pages that are not there
    for page in pages:
        html = page.read_text()
        fetched = Fetched()
        fetched.feed(html)
        assert fetched.addresses
        for address in fetched.addresses:
            assert "//" not in address, address
            assert page.name == "404.html" or (page.parent / address.partition("?")[0]).is_file(), address
        assert 'class="arithmatex"' not in html  # every formula was translated
        assert "<!-- keys" not in html
    theory = (tmp_path / "site" / "theory.html").read_text()
    assert theory.count("<math") > 100
    assert '<span class="formula-number">(A6, A7)</span>' in theory
    scene = (tmp_path / "site" / "formats" / "scene.html").read_text()
    assert re.search(r"<code>torsion_radius</code></td>\s*<td>number &gt; 0</td>\s*<td>required</td>", scene)
    result = (tmp_path / "site" / "formats" / "result.html").read_text()
    assert "<code>nearest_miss</code>" in result
    commands = (tmp_path / "site" / "reference" / "command_line.html").read_text()
    assert "pinograsp database build" in commands
    assert "<td>1304</td>" in commands
    assert "<code>score</code>" in commands
