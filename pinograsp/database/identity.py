"""Identity of a database: a robot, an enclosure and margins; nothing of objects or tasks."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, field_validator

from ..descriptions import RobotDescription, Scene
from ..descriptions.composition import UrdfPart
from ..descriptions.mesh_files import CONTENT
from ..descriptions.task import Margins
from ..descriptions.values import wrong
from ..disk import digest, digest_of
from ..kinematics.hand_posture import hand_opening
from ..kinematics.robot import Robot
from ..memo import remembered

MEANING = {
    "robot": "URDF, SRDF, meshes and their convex pieces, arm joints with limits, hand posture and wrist link",
    "enclosure": "walls, mounting pose and fixed obstacles",
    "margins": "least distances that the configurations keep",
}
"""Content that each part's hash is taken of."""


class WallsContent(BaseModel):
    """Two corners, m."""

    min: tuple[FiniteFloat, FiniteFloat, FiniteFloat]
    max: tuple[FiniteFloat, FiniteFloat, FiniteFloat]


class RobotContent(BaseModel):
    """What is read of the part about the robot; of the whole only the hash counts."""

    model_config = ConfigDict(extra="allow")

    joints: Annotated[list[Annotated[str, Field(pattern="^[^\x00]+$")]], Field(min_length=1)]

    @field_validator("joints")
    @classmethod
    def _different(cls, joints: list[str]) -> list[str]:
        if len(set(joints)) < len(joints):
            raise wrong("two joints have the same name")
        return joints


class EnclosureContent(BaseModel):
    """The same of the part about the enclosure."""

    model_config = ConfigDict(extra="allow")

    walls: WallsContent


class IdentityContent(BaseModel):
    """An identity as JSON data."""

    model_config = ConfigDict(extra="forbid")

    robot: RobotContent
    enclosure: EnclosureContent
    margins: dict[str, Annotated[FiniteFloat, Field(ge=0.0)]]


@dataclass(frozen=True)
class Identity:
    """Content of the three parts, as JSON data."""

    robot: dict[str, Any]
    enclosure: dict[str, Any]
    margins: dict[str, Any]

    @classmethod
    def of(cls, robot: Robot, scene: Scene, margins: Margins) -> Identity:
        """Return the identity of a database for this robot, the enclosure of this scene and these margins."""
        return cls(
            robot=_robot_part(robot.unmounted),
            enclosure={
                "walls": scene.enclosure.model_dump(mode="json"),
                "mounting": scene.mounting.model_dump(mode="json"),
                "obstacles": {
                    name: body.model_dump(mode="json", context=CONTENT) for name, body in scene.obstacles.items()
                },
            },
            margins=margins.model_dump(mode="json", include={"enclosure", "robot"}),
        )

    @classmethod
    def from_json(cls, text: str) -> Identity:
        """Return the identity that `to_json` wrote."""
        data = json.loads(text)
        return cls(data["robot"], data["enclosure"], data["margins"])

    def to_json(self) -> str:
        """Return the identity as canonical JSON."""
        return json.dumps({part: getattr(self, part) for part in MEANING}, sort_keys=True)

    @property
    def digest(self) -> str:
        """SHA-256 of the whole."""
        return digest(self.to_json().encode())

    def hash_of(self, part: str) -> str:
        """Return the first 12 digits of the SHA-256 of one part."""
        text = json.dumps(getattr(self, part), sort_keys=True)
        return digest(text.encode())[:12]

    def differences(self, other: Identity) -> list[str]:
        """Say, part by part, how another identity differs: both hashes, their meaning and the keys that differ."""
        found = []
        for part, meaning in MEANING.items():
            mine, theirs = getattr(self, part), getattr(other, part)
            if mine != theirs:
                keys = ", ".join(key for key in mine.keys() | theirs.keys() if mine.get(key) != theirs.get(key))
                hashes = f"{self.hash_of(part)} in the database, {other.hash_of(part)} wanted"
                found.append(f"another {part} ({hashes}; the hash of {meaning}; different: {keys})")
        return found


@remembered
def _robot_part(robot: Robot) -> dict[str, Any]:
    description, size = robot.description, robot.arm_size
    meshes = sorted({digest_of(Path(mesh)) for mesh in robot.urdf.meshes})
    return {
        "files": {key: digest_of(file) for key, file in description.files.items()},
        "composition": _composition(description),
        "meshes": digest("".join(meshes).encode()),
        "collision": description.collision.model_dump(mode="json"),
        "joints": list(description.arm.joints),
        "lower": robot.lower[:size].tolist(),
        "upper": robot.upper[:size].tolist(),
        "hand": _open_hand(robot),
        "wrist": description.arm.wrist,
    }


def _open_hand(robot: Robot) -> dict[str, float]:
    """Return the angles of the hand's joints, rad (m), and of others that the robot file holds somewhere."""
    q = robot.joint_positions(np.concatenate([np.zeros(robot.arm_size), hand_opening(robot)]))
    angles = dict(zip(robot.joint_names, q.tolist(), strict=True))
    hand = {robot.joint_names[joint] for joint in robot.hand_joints} | robot.description.hand.rest.keys()
    return {name: angles[name] for name in sorted(hand)}


def _composition(description: RobotDescription) -> list[dict[str, Any]]:
    """Return how the URDF is put together, without the addresses of the files."""
    parts: list[UrdfPart] = [description, *description.attach]
    fields, later = {"root", "leave_out", "to", "prefix", "position", "rpy"}, {"hold", "use_visual"}
    # Keys that robot files did not have once count where they are given: databases of then stay good.
    given = [part.model_dump(mode="json", include=later, exclude_defaults=True) for part in parts]
    return [part.model_dump(mode="json", include=fields) | more for part, more in zip(parts, given, strict=True)]
