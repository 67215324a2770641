"""The picture of a grasp: symbols, what is drawn, the page."""

import base64
import dataclasses
import gzip
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from pinograsp.descriptions import load_robot_description, load_scene
from pinograsp.descriptions.urdf import read_urdf
from pinograsp.disk import write_whole
from pinograsp.errors import InputError
from pinograsp.geometry.filled import center_of_mass_world
from pinograsp.results import Contact, Cost, Grasp, Result, Setup
from pinograsp.results.configuration_check import ConfigurationCheck
from pinograsp.verification.certificate import Certificate, Figure, PairClearance
from pinograsp.visualization import approach, camera, colors, show, symbols, write_html
from pinograsp.visualization.forces import LONGEST_ARROW
from pinograsp.visualization.regions import painted_surface
from pinograsp.visualization.scene import draw_scene
from pinograsp.visualization.viewer import Recorder, Visualizer

KNUCKLE = 0.12
FINGERS = {
    "left_knuckle": 1,
    "mimic_right_knuckle": -1,
    "mimic_left_inner_knuckle": 1,
    "mimic_right_inner_knuckle": -1,
    "mimic_left_finger_tip": -1,
    "mimic_right_finger_tip": 1,
}
ARM = (1.224, -0.638, 0.231, 1.344, 1.899, -1.698, 0.737 + math.pi / 2)


@pytest.fixture(scope="module")
def robot():
    return load_robot_description("gen3_2f85")


@pytest.fixture(scope="module")
def scene():
    return load_scene("glovebox")


@pytest.fixture(scope="module")
def grasp(robot, scene):
    """Sim. 1 of the paper, roughly: the jaw closes along world y."""
    center, radius = center_of_mass_world(scene.objects["sphere"]), scene.objects["sphere"].shape.radius

    def contact(pad, side):
        n = np.array([0.0, side, 0.0])
        point = center + radius * n
        return Contact(pad, f"{pad}_tip", point, n, np.array([0.0, -3.63 * side, 1.0]), 0.0, point, np.eye(4))

    joints = {f"joint_{i}": angle for i, angle in enumerate(ARM, 1)}
    joints |= {f"robotiq_85_{name}_joint": sign * KNUCKLE for name, sign in FINGERS.items()}
    figures = (
        Figure("enclosure clearance", 31.25, 5.0, "mm", "at least", "forearm <-> wall"),
        Figure("force balance", 2e-3, 1e-6, "N", "at most"),
    )
    return Grasp(
        start=0,
        count=3,
        joints=joints,
        q_arm=np.array(ARM),
        synergy=np.array([KNUCKLE]),
        contact_parameters=np.zeros(4),
        internal_forces=np.array([3.63]),
        q_r={},
        cost=Cost(2.1791, 0.0425, 2.1366),
        contacts=(contact("left", 1.0), contact("right", -1.0)),
        certificate=Certificate(figures),
        T_world_wrist=np.eye(4),
        setup=Setup(robot, scene, "sphere"),
    )


def drawn(grasp):
    """Return meshcat's objects and transforms of a grasp by node, and the recorder."""
    recorder = Recorder()
    show(grasp, Visualizer(window=recorder))
    objects, transforms = {}, {}
    for command in recorder.commands:
        node = command["path"].removeprefix("/meshcat/pinograsp").lstrip("/")
        if command["type"] == "set_object":
            objects[node] = command["object"]
        elif command["type"] == "set_transform":
            transforms[node] = np.array(command["matrix"]).reshape(4, 4).T
    return objects, transforms, recorder


def files(grasp):
    """Return the mesh files, as text, that are drawn of the robot's links."""
    objects, _, _ = drawn(grasp)
    nodes = {node.split("/")[-1]: content["object"] for node, content in objects.items() if node.startswith("robot/")}
    return {name: node["data"] for name, node in nodes.items() if node["type"] == "_meshfile_object"}


@pytest.fixture(scope="module")
def picture(grasp):
    return drawn(grasp)


def ends(piece):
    """Return where a frustum starts and ends in the world, by its pose."""
    half = np.array([0.0, piece.geometry.height / 2, 0.0])
    R, p = piece.T[:3, :3], piece.T[:3, 3]
    return p - R @ half, p + R @ half


DIRECTIONS = [*np.eye(3), *-np.eye(3), np.array([0.3, -0.2, 0.9]), np.array([1e-9, -1.0, 0.0])]


@pytest.mark.parametrize("direction", DIRECTIONS, ids=str)
def test_arrow_goes_from_tail_to_tip(direction):
    tail = np.array([0.8, 0.1, -0.2])
    pieces = symbols.arrow(tail, tail + 0.1 * direction, 0.003)
    start, neck = ends(pieces["shaft"])
    head_start, tip = ends(pieces["head"])
    np.testing.assert_allclose(start, tail, atol=1e-12)
    np.testing.assert_allclose(tip, tail + 0.1 * direction, atol=1e-12)
    np.testing.assert_allclose(neck, head_start, atol=1e-12)
    assert pieces["head"].geometry.radiusTop == 0.0
    for piece in pieces.values():
        R = piece.T[:3, :3]
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) == pytest.approx(1.0)


@pytest.mark.parametrize("axis", DIRECTIONS[:6], ids=str)
def test_friction_cone_opens_from_the_apex_with_slope_mu(axis):
    apex = np.array([0.1, 0.2, 0.3])
    cone = symbols.friction_cone(apex, axis, mu=0.9, height=0.03)
    point, rim = ends(cone)
    np.testing.assert_allclose(point, apex, atol=1e-12)
    np.testing.assert_allclose(rim, apex + 0.03 * axis, atol=1e-12)
    assert cone.geometry.radiusBottom == 0.0
    assert math.atan2(cone.geometry.radiusTop, cone.geometry.height) == pytest.approx(math.atan(0.9))


def test_a_box_has_twelve_edges_of_its_lengths():
    low, high = np.array([0.0, -1.0, 2.0]), np.array([0.5, 1.0, 5.0])
    edges = symbols.box_edges(low, high, 0.01)
    lengths = sorted(piece.geometry.height for piece in edges.values())
    assert lengths == pytest.approx([0.5] * 4 + [2.0] * 4 + [3.0] * 4)


def test_everything_is_drawn(picture):
    objects, transforms, _ = picture
    expected = {"object", "wrench/shaft", "wrench/head"}
    expected |= {f"enclosure/wall_{axis}_{side}" for axis in "xyz" for side in ("min", "max")}
    for pad in ("left", "right"):
        parts = ("desired", "point", "cone", "force/shaft", "force/head")
        expected |= {f"contacts/{pad}/{part}" for part in parts}
    assert expected <= set(objects)
    assert expected <= set(transforms)
    assert sum(node.startswith("robot/visuals/") for node in objects) == 17
    assert sum(node.startswith("enclosure/edges/") for node in objects) == 12


def test_the_robot_hangs_at_its_mounting_with_its_pads_at_the_contacts(picture, grasp, scene):
    _, transforms, _ = picture
    np.testing.assert_allclose(transforms["robot"], scene.mounting.matrix, atol=1e-12)
    for contact in grasp.contacts:
        tip = transforms["robot"] @ transforms[f"robot/visuals/robotiq_85_{contact.pad}_finger_tip_link_0"]
        assert np.linalg.norm(tip[:3, 3] - contact.point) < 0.06


def test_forces_end_at_the_contacts_in_one_scale(picture, grasp, scene):
    objects, transforms, _ = picture
    scale = LONGEST_ARROW / np.linalg.norm([3.63, 1.0])
    for contact in grasp.contacts:
        node = f"contacts/{contact.pad}/force/"
        tip = head_end(objects, transforms, node)
        np.testing.assert_allclose(tip, contact.point, atol=1e-9)
    center = center_of_mass_world(scene.objects["sphere"])
    tip = head_end(objects, transforms, "wrench/")
    np.testing.assert_allclose(tip, center + scale * np.array([0.0, 0.0, -2.0]), atol=1e-9)


def head_end(objects, transforms, node):
    height = objects[node + "head"]["geometries"][0]["height"]
    return (transforms[node + "head"] @ np.array([0.0, height / 2, 0.0, 1.0]))[:3]


def test_the_camera_is_outside_the_box_and_turns_about_its_target(picture, scene):
    _, transforms, _ = picture
    view = camera.whole_box(scene, scene.task("sphere"))
    outside = [n @ view.position < d for n, d in scene.enclosure.walls.values()]
    assert any(outside)
    np.testing.assert_allclose(transforms[""][:3, 3], -view.target)


def test_the_close_up_copes_with_contacts_above_each_other(grasp, scene):
    center = center_of_mass_world(scene.objects["sphere"])
    shifts = (np.array([0.0, 0.0, 0.03]), np.array([0.0, 0.0, -0.03]))
    contacts = tuple(
        dataclasses.replace(contact, point=center + shift)
        for contact, shift in zip(grasp.contacts, shifts, strict=True)
    )
    view = camera.close_up(dataclasses.replace(grasp, contacts=contacts), scene, scene.task("sphere"))
    assert np.isfinite(view.position).all()


def test_the_page_holds_figures_and_picture_and_loads_nothing(grasp, tmp_path):
    file = tmp_path / "grasp.html"
    write_html(grasp, file, caption="<b>Sim. 1</b> & more")
    page = file.read_text(encoding="utf-8")
    for text in ("gen3_2f85", "glovebox", "2.179", "0.0425 mm²", "2.137", "(0.00, -3.63, 1.00) N", "3.77 N"):
        assert text in page
    assert "<td>31.2 mm</td><td>≥ 5 mm</td>" in page
    assert "forearm &lt;-&gt; wall" in page
    assert 'class="fails"><td>force balance' in page
    assert "Certificate: not verified" in page
    assert "&lt;b&gt;Sim. 1&lt;/b&gt; &amp; more" in page
    assert not re.search(r"<(script|link|img|iframe)[^>]*(src|href)=", page)
    assert list(tmp_path.iterdir()) == [file]

    (commands,) = re.findall(r'draw\("([A-Za-z0-9+/=]+)"\)', page)
    assert b"contacts/left/force/head" in gzip.decompress(base64.b64decode(commands))


def test_an_old_page_is_replaced_and_a_failed_one_leaves_it(grasp, tmp_path):
    file = tmp_path / "grasp.html"
    file.write_text("old")
    joints = {name: angle for name, angle in grasp.joints.items() if name != "joint_3"}
    with pytest.raises(InputError, match="joint_3"):
        write_html(dataclasses.replace(grasp, joints=joints), file)
    assert file.read_text() == "old"
    write_whole(file, "new")
    assert file.read_text() == "new"
    assert list(tmp_path.iterdir()) == [file]


def test_errors_of_input(grasp, robot, scene, tmp_path):
    with pytest.raises(InputError, match="no task 'ball'"):
        write_html(dataclasses.replace(grasp, setup=Setup(robot, scene, "ball")), tmp_path / "a.html")
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match=r"a\.html: cannot be written: "):
        write_whole(tmp_path / "file" / "a.html", "text")


def test_of_a_result_the_best_grasp_is_drawn(grasp, robot, scene, tmp_path):
    setup = Setup(robot, scene, "sphere")
    loose = dataclasses.replace(grasp, setup=None)
    worse = dataclasses.replace(loose, joints=dict.fromkeys(grasp.joints, 0.0))
    result = Result(setup, (loose, worse), 2, {"converged": 2}, 2, 0, {})
    assert [found.setup for found in result.grasps] == [setup, setup]
    of_result, best, other = (
        {node: T.tolist() for node, T in drawn(drawable)[1].items()} for drawable in (result, grasp, result.grasps[1])
    )
    assert of_result == best != other
    write_html(result, tmp_path / "result.html")
    assert "2.179" in (tmp_path / "result.html").read_text()


def test_the_page_of_a_result_compares_its_grasps(grasp, robot, scene, tmp_path):
    def made_up(start, number, x):
        figures = (
            Figure("Q_force", number, -math.inf, "m/s^2", "at least"),
            Figure("Q_torque", 2.5, -math.inf, "m/s^2", "at least"),
            Figure("self clearance", 0.0123, 0.005, "m", "at least"),
        )
        T = np.eye(4)
        T[0, 3] = x
        return dataclasses.replace(
            grasp, start=start, count=2, certificate=Certificate(figures), T_world_wrist=T, setup=None
        )

    setup = Setup(robot, scene, "sphere")
    grasps = (made_up(0, 9.87, 0.0), made_up(1, 8.76, 0.001), made_up(2, 7.65, 0.3))
    result = Result(setup, grasps, 6, {"converged": 6}, 6, 0, {})
    write_html(result, tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert "2 different of 3 distinct grasps; the first is drawn" in page
    assert "<tr><td>1</td><td>4x</td><td>2.179</td><td>9.87</td><td>2.50</td><td>12.3</td><td>-</td>" in page
    assert "<tr><td>3</td><td>2x</td><td>2.179</td><td>7.65</td>" in page
    assert re.search(r"<td>Q_force<small>[^<]+</small></td><td>9.87 m/s²</td>", page)
    assert re.search(r"<td>reserve<small>[^<]+</small></td><td>-</td>", page)
    assert "<td>9.87 m/s²</td><td></td>" in page  # of the certificate: no limit
    write_html(result.grasps[2], tmp_path / "b.html")
    assert "distinct grasps" not in (tmp_path / "b.html").read_text()
    with pytest.raises(InputError, match="'beauty'"):
        write_html(result, tmp_path / "c.html", by="beauty")


@pytest.fixture(scope="module")
def refuted(grasp):
    """A configuration of the user's whose jaw is away from the object, its elbow in the wall."""
    figures = (
        Figure("enclosure clearance", -0.012, 0.005, "m", "at least", "forearm <-> wall"),
        Figure("contact gap", 0.0042, 1e-5, "m", "at most", "left"),
        Figure("friction", -0.5, 0.0, "N", "at least", "left"),
    )
    pairs = (
        PairClearance("self collision", "forearm", "base", -math.inf),
        PairClearance("enclosure clearance", "forearm", "<wall>", -0.012),
    )
    own = dataclasses.replace(grasp, start=None, count=0, certificate=Certificate(figures))
    return ConfigurationCheck(own, pairs)


def test_the_page_of_a_refuted_configuration_says_what_refutes_it(refuted, tmp_path):
    write_html(refuted, tmp_path / "a.html", caption="mine")
    page = (tmp_path / "a.html").read_text()
    panel = page[page.index('<div id="panel">') : page.index("<script>")]
    assert "<h1>Configuration</h1>" in panel
    begins, others = panel.index("<b>Not verified.</b> Refuted by"), panel.index("<table>")
    assert begins < others  # above all figures
    banner = panel[begins:others]
    assert "<li>enclosure clearance: -12 mm, not ≥ 5 mm<small>forearm &lt;-&gt; wall</small></li>" in banner
    assert "<li>contact gap: 4.2 mm, not ≤ 0.01 mm<small>left</small></li>" in banner
    assert banner.count("<li>") == 3
    assert "Certificate: not verified" in panel
    assert "<td>self collision<small>forearm - base</small></td><td>overlap</td>" in panel
    assert "<td>enclosure clearance<small>forearm - &lt;wall&gt;</small></td><td>-12.0 mm</td>" in panel


def test_a_checked_configuration_is_drawn_like_its_grasp(refuted, tmp_path):
    of_check, of_grasp = ({n: T.tolist() for n, T in drawn(what)[1].items()} for what in (refuted, refuted.grasp))
    assert of_check == of_grasp
    good = Certificate((Figure("contact gap", 1e-6, 1e-5, "m", "at most", "left"),))
    verified = ConfigurationCheck(dataclasses.replace(refuted.grasp, certificate=good), ())
    write_html(verified, tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert "Not verified" not in page
    assert "Certificate: verified" in page


def test_at_most_ten_distances_are_listed(refuted, tmp_path):
    many = dataclasses.replace(refuted, clearances=refuted.clearances[1:] * 23)
    write_html(many, tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert page.count("<small>forearm - &lt;wall&gt;</small>") == 10
    assert "Distances below 50 mm, the least 10 of 23" in page


def test_what_cannot_be_drawn_is_refused(grasp, robot, scene, tmp_path):
    empty = Result(Setup(robot, scene, "sphere"), (), 1, {"infeasible": 1}, 0, 0, {})
    loose = dataclasses.replace(grasp, setup=None)
    for drawable, words in ((empty, "no grasp to draw"), (loose, "belongs to no result")):
        with pytest.raises(InputError, match=words):
            write_html(drawable, tmp_path / "a.html")
    assert not list(tmp_path.iterdir())


def test_a_composed_robot_is_drawn_with_every_part(grasp, paper, scene):
    """Arm and hand where the model has them, none of the hand that was left out, the materials of their own."""
    sigma = 1.9
    posture = np.array([*ARM, sigma])
    robot = paper.mounted(scene.mounting.matrix)
    setup = Setup(paper.description, scene, "sphere")
    held = dataclasses.replace(grasp, joints=paper.joints_by_name(posture), synergy=posture[7:], setup=setup)
    objects, transforms, _ = drawn(held)
    names = {node.split("/")[-1].removesuffix("_0"): node for node in objects if node.startswith("robot/")}
    assert names.keys() >= {"base_link", "bracelet_link", "palm", "left_distal", "right_distal"}
    assert not [name for name in names if "robotiq" in name]
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.joint_positions(posture))
    for link in ("left_distal", "palm"):
        origin = read_urdf(paper.description).tree.find(f"link[@name='{link}']/visual/origin")
        center = [0.0, 0.0, 0.0] if origin is None else [float(text) for text in origin.get("xyz").split()]
        expected = data.oMf[robot.model.getFrameId(link)].act(np.array(center))
        drawn_at = transforms["robot"] @ transforms[names[link]]
        np.testing.assert_allclose(drawn_at[:3, 3], expected, atol=1e-9)
    colors = {link: objects[names[link]]["materials"][0]["color"] for link in ("palm", "left_proximal")}
    assert colors["palm"] != colors["left_proximal"]


@pytest.mark.parametrize("content", [None, "this is not a mesh"])
def test_a_link_whose_mesh_for_show_cannot_be_read_is_drawn_as_it_collides(grasp, robot, scene, tmp_path, content):
    text = robot.urdf_file.read_text().replace("visual/forearm_link.dae", "visual/forearm.dae", 1)
    if content is not None:
        mesh = tmp_path / "forearm.dae"
        mesh.write_text(content)
        text = re.sub(r'package://[^"]*/forearm\.dae', f"file://{mesh}", text)
    (tmp_path / "robot.urdf").write_text(text)
    description = re.sub("urdf: .*", "urdf: robot.urdf", robot.source.read_text())
    (tmp_path / "robot.yaml").write_text(description)
    broken = dataclasses.replace(grasp, setup=Setup(load_robot_description(tmp_path), scene, "sphere"))
    assert files(broken) == files(grasp)  # the mesh for collisions is the same
    write_html(broken, tmp_path / "a.html")


def test_a_live_viewer_prints_nothing_and_ends_with_its_process():
    code = (
        "from pinograsp.visualization.viewer import live\n"
        "viewer = live()\n"
        "viewer['a'].set_transform()\n"
        "assert viewer.url().startswith('http://127.0.0.1')\n"
        "print(viewer.window.server_proc.pid)\n"
    )
    here = Path(__file__).parent.parent
    run = subprocess.run([sys.executable, "-c", code], cwd=here, capture_output=True, text=True, timeout=20, check=True)
    assert run.stderr == ""
    assert not Path(f"/proc/{int(run.stdout)}").exists()


def test_regions_are_painted(robot, tmp_path):
    scene = load_scene("glovebox_can")
    task = scene.task("can_region")
    can = scene.objects["can"].shape
    painted = painted_surface(can, task.contact_region)
    middles = painted.vertices[painted.faces].mean(axis=1)
    colours = painted.color[painted.faces]
    assert (colours == colours[:, :1]).all()  # a triangle has one colour
    green = colours[:, 0, 1] > 0.6
    assert np.array_equal(green, (middles[:, 2] >= 0.034) & (middles[:, 2] <= 0.059))
    assert 0.1 < green.mean() < 0.5
    recorder = Recorder()
    draw_scene(Visualizer(window=recorder), scene, task)
    drawn = [command for command in recorder.commands if command["path"].endswith("object")]
    assert any("vertexColors" in str(command) for command in drawn)
    assert set(colors.legend(regions=True, approach=False)) >= {"contact allowed", "contact forbidden"}
    assert "object" in colors.legend(regions=False, approach=False)


@pytest.mark.parametrize("angle", [0.1, 1.0, math.pi / 2, 2.5, math.pi])
def test_the_cone_of_approach_directions_opens_towards_the_hand(robot, scene, grasp, angle):
    content = scene.model_dump()
    content["objects"]["sphere"]["pose"]["rpy"] = (math.pi / 2, 0.0, 0.0)  # its y is the world's z
    content["tasks"]["sphere"]["approach"] = {"direction": (0.0, -1.0, 0.0), "angle": angle, "frame": "object"}
    turned = type(scene).model_validate(content)
    recorder = Recorder()
    show(dataclasses.replace(grasp, setup=Setup(robot, turned, "sphere")), Visualizer(window=recorder))
    assert [c["path"] for c in recorder.commands if c["path"].endswith("approach") and c["type"] == "set_object"]
    target = turned.objects["sphere"]
    piece = approach.cone(center_of_mass_world(target), np.array([0.0, 0.0, 1.0]), angle)
    points = piece.geometry.vertices @ piece.T[:3, :3].T
    np.testing.assert_allclose(piece.T[:3, 3], center_of_mass_world(target))
    lengths = np.linalg.norm(points, axis=1)
    off = np.arccos(np.clip(points[lengths > 0.1, 2] / approach.LENGTH, -1.0, 1.0))
    assert lengths.max() == pytest.approx(approach.LENGTH)
    assert off.max() == pytest.approx(angle, abs=1e-3)
    assert "cone of approach directions" in colors.legend(regions=False, approach=True)
