"""Results verified again from their files: nothing differs, whatever is changed is found."""

from __future__ import annotations

import copy
import dataclasses
import hashlib
import json
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinograsp import Difference, Progress, Result, Robot, Setup, cli, plan, read_json, verify, write_json
from pinograsp.descriptions import Scene, load_robot_description
from pinograsp.descriptions.robot_files import hashes_of
from pinograsp.descriptions.urdf import read_urdf
from pinograsp.mechanics import ContactModels, ForceLimits
from pinograsp.mechanics.barrier import barrier
from pinograsp.results import reverify
from pinograsp.results.decoding import decode_by_types
from pinograsp.results.provenance import provenance
from pinograsp.verification import Certificate, Claim, Figure
from pinograsp.verification.check import Verifier
from pinograsp.verification.force_cost import force_cost

Keys = tuple[str | int, ...]


@pytest.fixture(scope="module")
def result(gen3: Robot, glovebox: Scene) -> Result:
    return plan(gen3, glovebox, "sphere", starts=3, workers=1)


@pytest.fixture(scope="module")
def data(result: Result, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The content of the result's file."""
    file = tmp_path_factory.mktemp("result") / "result.json"
    write_json(result, file)
    content: dict[str, Any] = json.loads(file.read_text())
    return content


@pytest.fixture(scope="module")
def verifier(result: Result) -> Verifier:
    return Verifier(result.setup.robot, result.setup.scene, result.setup.task)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch, verifier: Verifier, result: Result) -> None:
    """One verifier for every result of the same robot and scene: it reads meshes for half a second."""

    def once(robot: Any, scene: Any, task: str) -> Verifier:
        return verifier if Setup(robot, scene, task) == result.setup else Verifier(robot, scene, task)

    monkeypatch.setattr(reverify, "Verifier", once)


Reread = Callable[[dict[str, Any]], Result]


@pytest.fixture
def reread() -> Reread:
    """Return a function that reads the result of this content, even if its parts do not fit: Python may make it."""
    return lambda content: decode_by_types(json.loads(json.dumps(content)))


def sealed(content: dict[str, Any]) -> dict[str, Any]:
    """Return a file's content with the digest that fits the rest."""
    rest = {key: value for key, value in content.items() if key != "digest"}
    canonical = json.dumps(rest, sort_keys=True, separators=(",", ":"))
    return content | {"digest": hashlib.sha256(canonical.encode()).hexdigest()}


def numbers(content: Any, path: Keys = ()) -> Iterator[tuple[Keys, float]]:
    """Yield every number in JSON data with its path."""
    if isinstance(content, (dict, list)):
        for key, part in content.items() if isinstance(content, dict) else enumerate(content):
            yield from numbers(part, (*path, key))
    elif isinstance(content, (int, float)) and not isinstance(content, bool):
        yield path, content


def changed(content: dict[str, Any], path: Keys, value: Any) -> dict[str, Any]:
    """Return a copy with another value at a path."""
    copied = copy.deepcopy(content)
    part: Any = copied
    for key in path[:-1]:
        part = part[key]
    assert part[path[-1]] != value
    part[path[-1]] = value
    return copied


def a_little_more(value: float) -> float:
    """Return a number that is larger by a thousandth, at least by a nanometre; a whole number by one."""
    return value + 1 if isinstance(value, int) else value + max(1e-3 * abs(value), 1e-9)


# Nothing differs.


def test_a_written_result_stands(result: Result, data: dict[str, Any], reread: Reread) -> None:
    seen: list[Progress] = []
    back = reread(data)
    assert len(back.grasps) > 1
    assert not back.altered
    assert data == sealed(data)
    assert verify(back, progress=seen.append) == ()
    count = len(back.grasps)
    assert seen == [Progress("certificates", number, count) for number in range(1, count + 1)]
    assert verify(result) == ()  # also without a file


def test_soft_fingers_stand(soft_gen3: Robot, glovebox: Scene) -> None:
    result = plan(soft_gen3, glovebox, "sphere", starts=2, workers=1)
    assert any(contact.spin_torque for grasp in result.grasps for contact in grasp.contacts)
    assert verify(result) == ()


def test_a_result_without_grasps_stands(result: Result) -> None:
    empty = dataclasses.replace(result, grasps=(), counts={"failed": 3}, verified=0)
    assert [difference.what for difference in verify(empty)] == ["sum of counts"]


# Everything that is changed is found.

ONLY_BY_THE_DIGEST = {"start", "contact_parameters", "internal_forces", "q_r"}
"""Of a grasp: nothing else in the file says what they must be, as far as the check is concerned."""


def test_every_number_of_a_grasp_counts(data: dict[str, Any], reread: Reread, quick: None) -> None:
    """The digest finds every change; where it is made to fit, what follows from other numbers is found all the same."""
    found_by_digest, missed, tried = [], set(), []
    for path, value in numbers(data["grasps"][1]):
        tampered = changed(data, ("grasps", 1, *path), a_little_more(value))
        tried.append(path)
        found_by_digest.append(reread(tampered).altered)
        differences = verify(reread(sealed(tampered)))
        assert not any(difference.what == "content of the file" for difference in differences)
        if not differences:
            missed.add(path[0])
    assert all(found_by_digest)
    assert missed == ONLY_BY_THE_DIGEST
    assert {path[0] for path in tried} == set(data["grasps"][1])
    assert len(tried) > 80


@pytest.mark.parametrize(
    ("path", "value", "what"),
    [
        (("grasps", 0, "cost", "U"), 1.0, {"cost.U"}),
        (("grasps", 0, "synergy", 0), 0.5, {"synergy.0"}),
        (("grasps", 0, "contacts", 0, "link"), "palm", {"contacts.left.link"}),
        (
            ("grasps", 0, "contacts", 1, "desired_point"),
            [0.0, 0.0, 0.0],
            {f"contacts.right.desired_point.{i}" for i in range(3)},
        ),
        (
            ("grasps", 0, "certificate", "figures", 0, "where"),
            "nowhere",
            {"certificate.figures.enclosure clearance.where"},
        ),
        (("grasps", 0, "certificate", "figures", 0, "unit"), "mm", {"certificate.figures.enclosure clearance.unit"}),
    ],
    ids=lambda value: ".".join(map(str, value)) if isinstance(value, tuple) else None,
)
def test_a_difference_says_where(
    path: Keys, value: Any, what: set[str], data: dict[str, Any], reread: Reread, quick: None
) -> None:
    differences = verify(reread(sealed(changed(data, path, value))))
    assert {(difference.grasp, difference.what) for difference in differences} == {(1, name) for name in what}
    for difference in differences:
        assert difference.stated != difference.recomputed


def test_the_pose_of_a_pad_is_told_by_its_name(data: dict[str, Any], reread: Reread, quick: None) -> None:
    path = ("grasps", 1, "contacts", 1, "T_world_pad")
    T = np.array(data["grasps"][1]["contacts"][1]["T_world_pad"])
    T[:3, :2] = T[:3, 1::-1] * [1.0, -1.0]  # a quarter turn about the normal: nothing else notices
    found = verify(reread(sealed(changed(data, path, T.tolist()))))
    assert {(difference.grasp, difference.what.rsplit(".", 2)[0]) for difference in found} == {
        (2, "contacts.right.T_world_pad")
    }


def test_the_order_of_joints_counts(data: dict[str, Any], reread: Reread, quick: None) -> None:
    """It is that of `Grasp.q`; neither the digest nor a comparison by names sees it."""
    joints = data["grasps"][0]["joints"]
    turned = copy.deepcopy(data)
    turned["grasps"][0]["joints"] = dict(sorted(joints.items(), reverse=True))
    result = reread(turned)
    assert not result.altered
    assert verify(result) == (Difference(1, "order of joints", sorted(joints, reverse=True), list(joints)),)


def test_flags_count(data: dict[str, Any], reread: Reread, quick: None) -> None:
    """What the result does not keep, since it follows from the figures, is compared when the file is read."""
    for path in (("verified",), ("figures", 3, "holds")):
        tampered = sealed(changed(data, ("grasps", 0, "certificate", *path), False))
        assert [difference.what for difference in verify(reread(tampered))] == ["content of the file"]


def test_a_figure_that_is_left_out_or_added(data: dict[str, Any], reread: Reread, quick: None) -> None:
    figures = data["grasps"][0]["certificate"]["figures"]
    path = ("grasps", 0, "certificate", "figures")
    less = verify(reread(sealed(changed(data, path, figures[1:]))))
    assert {difference.what for difference in less} >= {f"certificate.figures.{figures[0]['name']}.value"}
    assert {difference.stated for difference in less} == {None}
    for more in (figures[0] | {"name": "beauty"}, figures[0]):
        found = verify(reread(sealed(changed(data, path, [more, *figures]))))
        assert found
        assert {difference.recomputed for difference in found} == {None}


def test_a_figure_in_front_of_another_one_of_its_name(data: dict[str, Any], reread: Reread, quick: None) -> None:
    """The false one is what a look-up by name finds."""
    figures = data["grasps"][0]["certificate"]["figures"]
    praised = figures[0] | {"value": 1.0}
    result = reread(sealed(changed(data, ("grasps", 0, "certificate", "figures"), [praised, *figures])))
    assert result.grasps[0].certificate[figures[0]["name"]].value == 1.0
    assert f"certificate.figures.{figures[0]['name']}.value" in {difference.what for difference in verify(result)}


def test_a_refuted_grasp_differs_even_if_it_says_so(result: Result, verifier: Verifier, quick: None) -> None:
    """A result holds verified grasps only."""
    grasp = result.grasps[0]
    contacts = tuple(
        dataclasses.replace(contact, force=0.0 * contact.force, spin_torque=0.0) for contact in grasp.contacts
    )
    dropped = dataclasses.replace(grasp, contacts=contacts)
    claim = dropped.claim
    dropped = dataclasses.replace(
        dropped,
        certificate=verifier.check(claim),
        cost=dataclasses.replace(
            grasp.cost, V=verifier.derive(claim).V, U=grasp.cost.phi_mm2 + verifier.derive(claim).V
        ),
    )
    honest = dataclasses.replace(result, grasps=(*result.grasps[1:], dropped))
    assert not dropped.certificate.verified
    last = len(honest.grasps)
    assert verify(honest) == (Difference(last, "certificate.verified", True, False),)


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda grasp: grasp["joints"].pop("joint_3"), "no value for joint joint_3"),
        (lambda grasp: grasp["contacts"].pop(), "one a pad"),
        (lambda grasp: grasp.update(contacts=[]), "one a pad"),
    ],
    ids=["a joint less", "a contact less", "no contacts"],
)
def test_a_grasp_that_cannot_be_checked_differs(
    damage: Callable[[dict[str, Any]], Any], words: str, data: dict[str, Any], reread: Reread, quick: None
) -> None:
    content = copy.deepcopy(data)
    damage(content["grasps"][0])
    [difference] = verify(reread(sealed(content)))
    assert (difference.grasp, difference.what) == (1, "certificate")
    assert words in difference.recomputed


def test_a_number_beyond_any_force_differs(data: dict[str, Any], reread: Reread, quick: None) -> None:
    tampered = sealed(changed(data, ("grasps", 0, "contacts", 0, "force", 0), 1e300))
    with np.errstate(all="ignore"):
        found = {difference.what for difference in verify(reread(tampered))}
    assert {"certificate.verified", "certificate.figures.friction.value", "cost.V"} <= found


@pytest.mark.parametrize(
    ("path", "value", "what"),
    [
        (("verified",), 2, "verified"),
        (("refuted",), 1, "refuted"),
        (("counts", "failed"), 7, "sum of counts"),
        (("starts",), 2, "starts"),
        (("provenance", "sha256", "urdf"), "0" * 64, "provenance.sha256.urdf"),
        (("provenance", "sha256", "meshes"), "0" * 64, "provenance.sha256.meshes"),
        (("setup", "robot", "digest"), "0" * 64, "provenance.sha256.robot"),
    ],
    ids=lambda value: ".".join(map(str, value)) if isinstance(value, tuple) else None,
)
def test_what_is_said_of_the_whole_counts(
    path: Keys, value: Any, what: str, data: dict[str, Any], reread: Reread
) -> None:
    found = verify(reread(sealed(changed(data, path, value))))
    assert (None, what) in {(difference.grasp, difference.what) for difference in found}


def test_the_order_counts(data: dict[str, Any], reread: Reread, quick: None) -> None:
    swapped = sealed(data | {"grasps": [*data["grasps"][1::-1], *data["grasps"][2:]]})
    assert verify(reread(swapped)) == (Difference(2, "place in the list", 2, 1),)
    ends = sealed(data | {"grasps": data["grasps"][::-1]})
    assert len(data["grasps"]) == 3
    assert verify(reread(ends)) == (Difference(1, "place in the list", 1, 3), Difference(3, "place in the list", 3, 1))


def test_figures_order_the_grasps_of_a_tier(result: Result, quick: None) -> None:
    """Figures that are made up differ, too; here only the places count."""
    costs = [grasp.cost.U for grasp in result.grasps]
    assert max(costs) < min(costs) + 1.0
    grasps = tuple(
        dataclasses.replace(grasp, certificate=Certificate((Figure("Q_force", Q, 0.0, "m/s^2", "at least"),)))
        for grasp, Q in zip(result.grasps, (1.0, 3.0, 2.0), strict=True)
    )
    made_up = dataclasses.replace(result, grasps=grasps)
    places = [found for found in verify(made_up) if found.what == "place in the list"]
    assert places == [Difference(2, "place in the list", 2, 1)]
    in_order = dataclasses.replace(result, grasps=made_up.ranked())
    assert not [found for found in verify(in_order) if found.what == "place in the list"]


@pytest.mark.parametrize(
    ("path", "factor", "what"),
    [
        (("objects", "sphere", "pose", "position", 1), 1.001, "certificate.figures.contact gap.value"),
        (("objects", "sphere", "shape", "radius"), 1.001, "certificate.figures.contact gap.value"),
        (("enclosure", "min", 2), 1.001, "certificate.figures.enclosure clearance.value"),
        (("mounting", "rpy", 1), 1.001, "certificate.figures.contact on pad.value"),
        (("tasks", "sphere", "contact", "friction"), 1.001, "cost.V"),
        (("tasks", "sphere", "contact", "max_force"), 1.001, "certificate.figures.force limit.limit"),
        (("tasks", "sphere", "force_weight"), 1.001, "cost.U"),
        (("tasks", "sphere", "margin", "enclosure"), 0.999, "certificate.figures.enclosure clearance.limit"),
        (("tasks", "sphere", "desired_contacts", 0, 1), 1.001, "contacts.left.desired_point.1"),
        (("tasks", "sphere", "wrench", "force", 2), 1.001, "certificate.figures.force balance.value"),
    ],
    ids=lambda value: ".".join(map(str, value)) if isinstance(value, tuple) else None,
)
def test_the_scene_counts(path: Keys, factor: float, what: str, data: dict[str, Any], reread: Reread) -> None:
    path = ("setup", "scene", *path)
    value = dict(numbers(data))[path]
    assert value != 0.0
    found = {re.sub("left|right", "left", d.what) for d in verify(reread(sealed(changed(data, path, factor * value))))}
    assert what in found


# The cost of forces, written a second time.


@pytest.mark.parametrize("soft", [False, True])
def test_the_cost_of_forces_is_that_of_the_optimiser(
    soft: bool, soft_gen3: Robot, gen3: Robot, glovebox: Scene
) -> None:
    """Within the limits and beyond them, where the parabolas count."""
    rng = np.random.default_rng(5)
    pads, task = (soft_gen3 if soft else gen3).description.pads, glovebox.tasks["sphere"]
    constants = task.contact
    limits = ForceLimits(constants.friction, constants.min_normal_force, constants.max_force, constants.kappa)
    radius = np.array([pad.contact.torsion_radius if soft else 0.0 for pad in pads])
    models = ContactModels(radius, np.ones(8 if soft else 6))
    beyond = 0
    for scale in (0.1, 1.0, 3.0) * 40:
        normals = rng.normal(size=(2, 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        forces = scale * (normals + 0.4 * rng.normal(size=(2, 3)))
        spins = 1e-3 * scale * rng.normal(size=2) if soft else np.zeros(2)
        f = np.column_stack([forces, spins]).ravel() if soft else forces.ravel()
        V = force_cost(Claim({}, np.zeros((2, 3)), forces, spins), normals, pads, task)
        assert pytest.approx(barrier(f, normals, models, limits).V, rel=1e-12) == V
        beyond += limits.strict_cost < V
    assert 10 < beyond < 110


# Files of the robot.


@pytest.fixture
def elsewhere(result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A result, read with relative paths, of a robot whose file, URDF and one mesh are in a folder of their own."""
    home = tmp_path / "home"
    home.mkdir()
    urdf = result.setup.robot.urdf_file.read_text()
    address = re.search(r'package://[^"]*collision/left_knuckle\.stl', urdf)
    assert address
    share = result.setup.robot.folders[-1]
    (home / "knuckle.stl").write_bytes((share / address[0].removeprefix("package://")).read_bytes())
    (home / "arm.urdf").write_text(urdf.replace(address[0], "knuckle.stl"))
    text = re.sub("(?m)^urdf: .*$", "urdf: arm.urdf", result.setup.robot.source.read_text())
    (home / "robot.yaml").write_text(text)
    monkeypatch.chdir(home)
    robot = load_robot_description("robot.yaml")
    assert not robot.source.is_absolute()
    setup = Setup(robot, result.setup.scene, result.setup.task)
    hashes = provenance(robot, setup.scene, hashes_of(robot, read_urdf(robot)))
    write_json(dataclasses.replace(result, setup=setup, provenance=hashes), home / "result.json")
    monkeypatch.chdir(tmp_path)
    return home


Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Return a function that runs `pinograsp verify` and gives exit code, output and errors."""

    def run_once(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["pinograsp", "verify", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        captured = capsys.readouterr()
        return int(ended.value.code or 0), captured.out, captured.err

    return run_once


def test_another_working_directory(elsewhere: Path, run: Run, result: Result) -> None:
    code, output, errors = run("home/result.json")
    assert (code, errors) == (0, "")
    assert output == f"{len(result.grasps)} grasps recomputed: every certificate stands\n"
    moved = read_json(elsewhere / "result.json")
    nothing = dataclasses.replace(moved, grasps=(), verified=0, refuted=0, counts={}, blocked={})
    write_json(nothing, elsewhere / "none.json")
    code, output, _ = run("home/none.json")
    said = "the result has no grasp, so no certificate was recomputed; the rest of it stands\n"
    assert (code, output) == (0, said)


def test_a_mesh_that_was_changed(elsewhere: Path) -> None:
    """Its header only, so that the certificates stand."""
    mesh = elsewhere / "knuckle.stl"
    mesh.write_bytes(b"another header".ljust(80) + mesh.read_bytes()[80:])
    [difference] = verify(read_json(elsewhere / "result.json"))
    assert difference.what == "provenance.sha256.meshes"


def test_a_urdf_that_is_not_there(elsewhere: Path, run: Run) -> None:
    (elsewhere / "arm.urdf").unlink()
    assert read_json(elsewhere / "result.json").best  # reading needs no file of the robot
    code, output, errors = run(elsewhere / "result.json")
    assert (code, output) == (2, "")
    assert errors.startswith(
        f"error: {elsewhere / 'robot.yaml'}: urdf: arm.urdf was not found. Looked in {elsewhere}, "
    )
    assert errors.count("\n") == 1


# The command line.


def test_one_line_a_difference(data: dict[str, Any], run: Run, quick: None, tmp_path: Path) -> None:
    file = tmp_path / "of [one].json"
    names = [figure["name"] for figure in data["grasps"][0]["certificate"]["figures"]]
    path = ("grasps", 0, "certificate", "figures", names.index("force limit"), "value")
    limit = dict(numbers(data))[path]
    file.write_text(json.dumps(changed(data, path, 2.0)))
    code, output, errors = run(file)
    assert code == 1
    assert errors.endswith("its file was changed since it was written\n")
    first, second, summary = output.splitlines()
    assert first == 'result: content of the file: "unchanged" stated, "changed since it was written" recomputed'
    stated, recomputed = re.fullmatch(
        r"grasp 1: \S+force limit\.value: (\S+) stated, (\S+) recomputed", second
    ).groups()  # type: ignore[union-attr]
    assert (float(stated), float(recomputed)) == (2.0, pytest.approx(limit, rel=1e-9))
    assert summary == f"{len(data['grasps'])} grasps recomputed: 2 differences"


def test_differences_as_json(data: dict[str, Any], run: Run, quick: None, tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    file.write_text(json.dumps(data))
    code, output, _ = run(file, "--json")
    names = {"robot": "gen3_2f85", "scene": "glovebox", "task": "sphere"}
    assert (code, json.loads(output)) == (0, names | {"grasps": len(data["grasps"]), "differences": []})
    file.write_text(json.dumps(changed(data, ("grasps", 0, "q_r", next(iter(data["grasps"][0]["q_r"]))), 9.0)))
    code, output, _ = run(file, "--json")
    [difference] = json.loads(output)["differences"]
    assert code == 1
    assert difference == {
        "grasp": None,
        "what": "content of the file",
        "stated": "unchanged",
        "recomputed": "changed since it was written",
    }


def test_files_that_cannot_be_used(run: Run, data: dict[str, Any], tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    for content, words in (
        (None, "cannot be read"),
        ("{", "is not valid JSON"),
        (json.dumps(data | {"format_version": 2}), "format_version: format version 2 cannot be read"),
        ('{"format_version": NaN}', "is not valid JSON: NaN is no number of JSON"),
        (json.dumps(data | {"setup": 3}), "setup: is damaged"),
        (json.dumps(data | {"provenance": []}), "provenance: is damaged"),
        (json.dumps(data | {"grasps": [data["grasps"][0] | {"start": 10**400}]}), "grasps[0].start: is damaged"),
        (json.dumps(data | {"verified": -1}), "verified: is damaged"),
    ):
        if content is not None:
            file.write_text(content)
        code, output, errors = run(file)
        assert (code, output) == (2, "")
        assert errors.startswith(f"error: {file}: {words}")
        assert errors.rstrip().endswith(("Check the path", "Write it anew", "Plan again", "plan again"))
        assert errors.count("\n") == 1
