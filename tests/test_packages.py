"""Where the files of a URDF are: folders of packages by whatever name, and addresses of every kind."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh
import yaml
from conftest import TOY_ROBOT, TOY_URDF, Run

import pinograsp
from pinograsp import FileError, InputError
from pinograsp.descriptions import load_robot_description
from pinograsp.descriptions.packages import Address, readings
from pinograsp.descriptions.urdf import read_urdf

LEFT_BOX = '<origin xyz="0.005 0 0.02"/><geometry><box size="0.01 0.02 0.04"/></geometry>'


def robot_file(folder: Path, address: str, packages: tuple[str, ...] = ()) -> Path:
    """Write the toy, whose left finger is a mesh at an address."""
    folder.mkdir(parents=True, exist_ok=True)
    assert LEFT_BOX in TOY_URDF
    text = TOY_URDF.replace(LEFT_BOX, f'<geometry><mesh filename="{address}"/></geometry>')
    (folder / "toy.urdf").write_text(text)
    (folder / "robot.yaml").write_text(yaml.safe_dump(TOY_ROBOT | {"packages": list(packages)}))
    return folder / "robot.yaml"


def package(folder: Path, name: str | None, mesh: str = "meshes/f.stl") -> Path:
    """Write a package with a mesh, and its `package.xml` if it has a name there; return the mesh."""
    file = folder / mesh
    file.parent.mkdir(parents=True, exist_ok=True)
    trimesh.creation.box(bounds=[[0.0, -0.01, 0.0], [0.01, 0.01, 0.04]]).export(file)
    if name is not None:
        (folder / "package.xml").write_text(
            f'<?xml version="1.0"?>\n<package format="2">\n <name> {name} </name></package>'
        )
    return file


def mesh_of(file: Path, packages: tuple[str, ...] = ()) -> Path:
    """Return where the mesh of the left finger is found."""
    tree = read_urdf(load_robot_description(file, packages)).tree
    return next(Path(mesh.get("filename", "")) for mesh in tree.iterfind("link/collision/geometry/mesh"))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("package://jaw/meshes/f.stl", Address("jaw", "meshes/f.stl")),
        ("model://jaw/meshes/f.stl", Address("jaw", "meshes/f.stl")),
        ("$(find jaw)/meshes/f.stl", Address("jaw", "meshes/f.stl")),
        ("file://$(find-pkg-share jaw)/meshes/f.stl", Address("jaw", "meshes/f.stl")),
        ("file:///tmp/f.stl", Address(None, "/tmp/f.stl")),
        ("file://localhost/tmp/f.stl", Address(None, "/tmp/f.stl")),
        ("file:/tmp/f.stl", Address(None, "/tmp/f.stl")),
        ("meshes/f.stl", Address(None, "meshes/f.stl")),
    ],
)
def test_addresses_are_read(text: str, expected: Address) -> None:
    assert readings(text) == [expected]


@pytest.mark.parametrize("scheme", ["package://jaw/", "model://jaw/", "$(find jaw)/", "file://$(find-pkg-share jaw)/"])
@pytest.mark.parametrize("folder", ["jaw", "jaw-main", "deep/er/jaw_fork"])
def test_a_package_is_found_by_its_own_name(scheme: str, folder: str, tmp_path: Path) -> None:
    """In a folder of its name, or one whose `package.xml` has the name."""
    mesh = package(tmp_path / "ws" / folder, None if folder == "jaw" else "jaw")
    package(tmp_path / "ws" / "another", "jaw_support")
    assert mesh_of(robot_file(tmp_path / "r", f"{scheme}meshes/f.stl", ("../ws",))) == mesh
    assert mesh_of(robot_file(tmp_path / "r", f"{scheme}meshes/f.stl"), (str(tmp_path / "ws"),)) == mesh


def test_the_folder_of_a_package_that_is_given_goes_first(tmp_path: Path) -> None:
    given, other = package(tmp_path / "mine", None), package(tmp_path / "ws" / "jaw", "jaw")
    address = "package://jaw/meshes/f.stl"
    assert mesh_of(robot_file(tmp_path / "r", address, ("../ws", "jaw=../mine"))) == given
    assert mesh_of(robot_file(tmp_path / "r", address, ("../ws",))) == other
    assert mesh_of(tmp_path / "r" / "robot.yaml", (f"jaw={tmp_path / 'mine'}",)) == given


@pytest.mark.parametrize("written", ["my%20jaw/a%2Bb.stl", "my jaw/a+b.stl", "my jaw\\a+b.stl", "./my%20jaw\\a+b.stl"])
def test_spaces_and_backslashes(written: str, tmp_path: Path) -> None:
    mesh = package(tmp_path / "r", None, "my jaw/a+b.stl")
    assert mesh_of(robot_file(tmp_path / "r", written)) == mesh
    assert mesh_of(robot_file(tmp_path / "r", f"package://r/{written.removeprefix('./')}", ("..",))) == mesh


def test_a_name_that_has_a_percent_sign_is_taken_as_it_is(tmp_path: Path) -> None:
    mesh = package(tmp_path / "r", None, "a%20b.stl")
    package(tmp_path / "r", None, "a b.stl")
    assert mesh_of(robot_file(tmp_path / "r", "a%20b.stl")) == mesh


@pytest.mark.parametrize("address", ["Meshes/f.stl", "meshes/F.STL", "package://r/meshes/f.Stl"])
def test_another_case_is_said(address: str, tmp_path: Path) -> None:
    mesh = package(tmp_path / "r", None)
    with pytest.raises(FileError) as caught:
        mesh_of(robot_file(tmp_path / "r", address, ("..",)))
    assert f"There is {mesh}: upper and lower case count" in str(caught.value)
    assert caught.value.key == "link left" and address in caught.value.problem


@pytest.mark.parametrize("address", ["x" * 300, "package://" + "x" * 300 + "/a.stl", "package://r/" + "x" * 300])
def test_a_name_that_is_too_long_for_the_system_is_not_found(address: str, tmp_path: Path) -> None:
    package(tmp_path / "r", None)
    file = robot_file(tmp_path / "r", address, ("..",))
    with pytest.raises(FileError, match=r"x{300}.* was not found"):
        mesh_of(file)
    with pytest.raises(FileError, match=r"x{300}"):
        pinograsp.new_robot_file(tmp_path / "r" / "toy.urdf", tmp_path / "robots" / "robot.yaml")


def test_a_new_robot_file_is_told_of_another_case_in_a_package(tmp_path: Path) -> None:
    mesh = package(tmp_path / "jaw-main", "jaw")
    robot_file(tmp_path / "jaw-main" / "urdf", "package://jaw/Meshes/f.STL")
    with pytest.raises(FileError, match=f"There is {mesh}: upper and lower case count"):
        pinograsp.new_robot_file(tmp_path / "jaw-main" / "urdf" / "toy.urdf", tmp_path / "robots" / "robot.yaml")


def test_a_name_in_a_comment_is_not_that_of_a_package(tmp_path: Path) -> None:
    mesh = package(tmp_path / "ws" / "jaw-main", "jaw")
    file = tmp_path / "ws" / "jaw-main" / "package.xml"
    file.write_text(f"<!-- <name>template</name> -->{file.read_text()}")
    assert mesh_of(robot_file(tmp_path / "r", "package://jaw//meshes/f.stl", ("../ws",))) == mesh


def test_a_package_that_is_not_found_has_a_remedy(tmp_path: Path) -> None:
    file = robot_file(tmp_path / "r", "model://jaw/meshes/f.stl")
    with pytest.raises(FileError, match=r"packages: \[jaw=FOLDER\].*--packages jaw=FOLDER"):
        mesh_of(file)
    package(tmp_path / "r" / "jaw", None, "other.stl")
    with pytest.raises(FileError, match=r"The package is taken to be .*/jaw; .*--packages jaw=FOLDER"):
        mesh_of(file)


def test_nothing_outside_the_folders_is_read(tmp_path: Path) -> None:
    package(tmp_path, None, "outside.stl")
    (tmp_path / "ws").mkdir()
    for address in ("package://jaw/../../outside.stl", "../outside.stl", "..%2Foutside.stl", f"{tmp_path}/outside.stl"):
        with pytest.raises(FileError, match="was not found"):
            mesh_of(robot_file(tmp_path / "r", address, ("../ws", "jaw=../ws/jaw")))


@pytest.mark.parametrize("kind", ["above", "beside", "bare"])
def test_a_new_robot_file_names_the_folder_of_a_package(kind: str, tmp_path: Path) -> None:
    """That of the URDF, one beside it by `package.xml`, or one that has the mesh where no `package.xml` is."""
    own = tmp_path / "src" / "jaw-main"
    folder = tmp_path / "src" / "meshes_of_jaw" if kind == "beside" else own
    mesh = package(folder, None if kind == "bare" else "jaw")
    robot_file(own / "urdf", "package://jaw/meshes/f.stl")
    output = tmp_path / "robots" / "mine" / "robot.yaml"
    output.parent.mkdir(parents=True)
    draft = pinograsp.new_robot_file(own / "urdf" / "toy.urdf", output)
    output.write_text(draft.text)
    assert f"jaw=../../src/{folder.name}" in yaml.safe_load(draft.text)["packages"]
    assert mesh_of(output) == mesh


@pytest.mark.parametrize("scheme", ["package://jaw/", "model://jaw/", "$(find jaw)/"])
def test_a_package_below_a_urdf_is_found_before_the_folder_of_the_robot_is_made(scheme: str, tmp_path: Path) -> None:
    mesh = package(tmp_path / "src" / "repo-main", "jaw")
    robot_file(tmp_path / "src", f"{scheme}meshes/f.stl")
    output = tmp_path / "robots" / "mine" / "robot.yaml"
    draft = pinograsp.new_robot_file(tmp_path / "src" / "toy.urdf", output)
    output.parent.mkdir(parents=True)
    output.write_text(draft.text)
    assert mesh_of(output) == mesh


def test_packages_on_the_command_line(run: Run, tmp_path: Path) -> None:
    """Of `robot new`, whose file then needs none, and of `robot check`."""
    mesh = package(tmp_path / "mine", None)
    file = robot_file(tmp_path / "r", "package://jaw/meshes/f.stl")
    given = ("--packages", f"jaw={tmp_path / 'mine'}")
    assert run("robot", "check", str(file), "--out", str(tmp_path))[0] == 1
    assert run("robot", "check", str(file), "--out", str(tmp_path), *given)[0] == 0
    assert run("robot", "new", str(file.parent / "toy.urdf"), "--out", str(tmp_path / "n"), *given)[0] == 0
    assert mesh_of(tmp_path / "n" / "robot.yaml") == mesh
    with pytest.raises(InputError, match="was not found"):
        mesh_of(file)


def test_a_tilde_is_the_home_of_the_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home = tmp_path / "home"
    mesh = package(home / "jaw", None)
    monkeypatch.setenv("HOME", str(home))
    assert pinograsp.Mesh(file="~/jaw/meshes/f.stl").file == mesh
    content = pinograsp.load_scene("glovebox").to_dict()
    content["objects"]["sphere"]["shape"] = {"type": "mesh", "file": "~/jaw/meshes/f.stl"}
    scene = tmp_path / "scene.yaml"
    scene.write_text(yaml.safe_dump(content))
    shape = pinograsp.load_scene(scene).objects["sphere"].shape
    assert isinstance(shape, pinograsp.Mesh)
    assert shape.file == mesh
    assert mesh_of(robot_file(tmp_path / "robot", "package://jaw/meshes/f.stl", ("~",))) == mesh
    assert mesh_of(robot_file(tmp_path / "other", "~/jaw/meshes/f.stl", ("~/jaw",))) == mesh
    (home / "toy.urdf").write_text((tmp_path / "robot" / "toy.urdf").read_text())
    file = tmp_path / "robot" / "robot.yaml"
    file.write_text(yaml.safe_dump(TOY_ROBOT | {"packages": ["~"], "urdf": "~/toy.urdf"}))
    assert load_robot_description(file).urdf_file == home / "toy.urdf"


def test_the_home_of_nobody_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"~nobody_at_all/f\.stl cannot be read"):
        pinograsp.Mesh(file="~nobody_at_all/f.stl")
    file = robot_file(tmp_path, "package://jaw/meshes/f.stl", ("~nobody_at_all",))
    with pytest.raises(FileError, match="jaw"):
        mesh_of(file)
    with pytest.raises(FileError, match="jaw"):
        mesh_of(robot_file(tmp_path, "package://jaw/meshes/f.stl"), ("~nobody_at_all",))


def test_a_new_robot_file_is_told_of_the_home_of_nobody(run: Run, tmp_path: Path) -> None:
    (tmp_path / "toy.urdf").write_text(TOY_URDF)
    code, _, err = run("robot", "new", "~nobody_at_all/toy.urdf", "--out", "new.yaml")
    assert (code, "~nobody_at_all/toy.urdf: " in err, "no such file" in err) == (2, True, True)
    code, _, err = run("robot", "new", "toy.urdf", "--packages", "~nobody_at_all", "--out", "new.yaml")
    assert code != 70, err
