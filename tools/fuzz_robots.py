"""Robot files, URDFs, SRDFs and the meshes of links, damaged and used."""

from __future__ import annotations

import random
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

import pinograsp
from fuzz_kind import RAW, require_finite, written, yaml_text
from fuzz_mutations import mutate_bytes, mutate_mesh, mutate_xml
from fuzz_sources import content_of, meshes, robot_files, shipped
from fuzz_toy import random_robot
from pinograsp.collision.solids import link_bodies
from pinograsp.verification.robot import VerifiedRobot

SHIPPED = 0.1
"""Share of the URDFs and SRDFs that are shipped ones: they take longer than the toy."""
OUTSIDE = 1e-6
"""How far a corner of a mesh may be outside of the pieces that cover it, as a share of the extent of the mesh."""


def make_robot(folder: Path, rng: random.Random) -> None:
    """Write a mutated robot file: of the toy, beside its URDF, or of a shipped robot."""
    if rng.random() < 0.6:
        urdf, tree = random_robot(rng)
        (folder / "toy.urdf").write_text(urdf)
    else:
        file = rng.choice(robot_files())
        for beside in file.parent.iterdir():
            shutil.copy(beside, folder)
        tree = content_of(file)
    written(folder / "robot.yaml", tree, rng)


def make_urdf(folder: Path, rng: random.Random) -> None:
    """Write the toy robot, or now and then a shipped one, with a mutated URDF."""
    if rng.random() < SHIPPED:
        tree, files = shipped(rng)
        urdf, tree = files["urdf"].read_text(), tree | {"urdf": "toy.urdf"}
    else:
        urdf, tree = random_robot(rng)
    (folder / "robot.yaml").write_text(yaml_text(tree))
    (folder / "toy.urdf").write_bytes(_mutated_xml(urdf, rng))


def make_srdf(folder: Path, rng: random.Random) -> None:
    """Write the toy robot, or now and then a shipped one, with a mutated SRDF."""
    tree, files = shipped(rng) if rng.random() < SHIPPED else ({}, {})
    if "srdf" in files:
        srdf, tree = files["srdf"].read_text(), tree | {"urdf": str(files["urdf"])}
    else:
        urdf, tree = random_robot(rng)
        pairs = '<disable_collisions link1="arm" link2="left" reason="Adjacent"/>' * 2
        pairs = pairs.replace("arm", tree["arm"]["wrist"])
        srdf = f'<robot name="toy"><group name="hand"><link name="left"/></group>{pairs}</robot>'
        (folder / "toy.urdf").write_text(urdf)
    (folder / "robot.yaml").write_text(yaml_text(tree | {"srdf": "toy.srdf"}))
    (folder / "toy.srdf").write_bytes(_mutated_xml(srdf, rng))


def _mutated_xml(text: str, rng: random.Random) -> bytes:
    document = ET.fromstring(text)
    if rng.random() >= RAW:
        mutate_xml(document, rng)
    data = ET.tostring(document)
    return mutate_bytes(data, rng) if rng.random() < RAW else data


def use_robot(folder: Path) -> None:
    """Load a robot and move it."""
    robot = pinograsp.load_robot(folder / "robot.yaml")
    require_finite([*robot.lower.tolist(), *robot.upper.tolist()], "limits")
    posture = 0.5 * (robot.lower + robot.upper)
    require_finite(robot.joints_by_name(posture), "joints")


def make_link(folder: Path, rng: random.Random) -> None:
    """Write the toy robot with a mutated mesh as its wrist."""
    source = rng.choice(meshes())
    file = folder / f"link{source.suffix.lower()}"
    file.write_bytes(mutate_mesh(source.read_bytes(), rng))
    scale = rng.choice(("", ' scale="0.001 0.001 0.001"', ' scale="1 -1 1"'))
    urdf, tree = random_robot(rng, f'<mesh filename="{file.name}"{scale}/>')
    (folder / "toy.urdf").write_text(urdf)
    (folder / "robot.yaml").write_text(yaml_text(tree))


def use_link(folder: Path) -> None:
    """Cover the links of a robot with convex pieces, read them again for the check, and compare."""
    robot = pinograsp.load_robot(folder / "robot.yaml")
    bodies = {body.name: body for body in link_bodies(robot)}
    for name, mesh in VerifiedRobot(robot.description).meshes.items():
        require_finite([*mesh.vertices.ravel().tolist(), mesh.radius], name)
        pieces = [
            np.asarray(solid.shape.points()) @ solid.placement[:3, :3].T + solid.placement[:3, 3]
            for solid in bodies[name].solids
        ]  # in the frame of the joint, which is that of the link in this robot
        require_finite(np.concatenate(pieces).ravel().tolist(), name)
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        excess = OUTSIDE * float((high - low).max())
        corners = np.concatenate(pieces)
        if (corners.min(axis=0) > low + excess).any() or (corners.max(axis=0) < high - excess).any():
            raise AssertionError(f"the pieces of {name} do not reach as far as its mesh")
