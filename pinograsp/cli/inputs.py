"""Inputs of commands: scenes with what the command line changes in them, robots, grasps of results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pinograsp

from ..errors import InputError
from .arguments import POSE, as_options, named_values
from .terminal import Terminal

ObjectPose = tuple[str, float, float, float, float, float, float]
"""Name of an object, its position, m, and its roll, pitch and yaw, rad."""


def read_scene(
    name: str,
    task: str,
    object_pose: ObjectPose | None = None,
    lock: Sequence[str] | None = None,
) -> pinograsp.Scene:
    """Return a scene whose object stands and whose joints are locked as the command line says.

    Args:
        name: file or name of a shipped scene.
        task: a task that it must have.
        object_pose: name of an object, its position, m, and its roll, pitch and yaw, rad.
        lock: texts such as `elbow=0.5`, rad (m).

    Raises:
        InputError: the scene cannot be read, has no such task or object, or a text cannot be understood.
    """
    scene = pinograsp.load_scene(name)
    its = scene.task(task)
    scene = moved(scene, object_pose)
    if lock:
        with scene_words(name, scene, task, object_pose, lock):
            scene = scene.with_task(task, lock={**its.lock, **named_values(lock, "--lock")})
    return scene


@contextmanager
def scene_words(
    name: str,
    scene: pinograsp.Scene,
    task: str | None = None,
    object_pose: ObjectPose | None = None,
    lock: Sequence[str] | None = None,
) -> Iterator[None]:
    """Have errors about a scene name what says it: the option that changed it, else its file.

    Args:
        name: file or name of a shipped scene.
        scene: which is there, as `read_scene` changed it.
        task: as of `read_scene`.
        object_pose: as of `read_scene`.
        lock: as of `read_scene`.
    """
    from ..descriptions.locate import scene_file
    from ..descriptions.scene_keys import scene_keys

    changed = {f"tasks.{task}.lock.{joint}": f"--lock {joint}" for joint in named_values(lock or (), "--lock")}
    if object_pose is not None:
        changed[f"objects.{object_pose[0]}.pose"] = "--object-pose"
    with scene_keys(scene, scene_file(name)), as_options(changed):
        yield


@contextmanager
def result_words(file: Path, result: pinograsp.Result) -> Iterator[None]:
    """Have errors about the scene of a result name the file of the result, which has it."""
    from ..descriptions.scene_keys import scene_keys

    with scene_keys(result.setup.scene, file):
        yield


def moved(scene: pinograsp.Scene, object_pose: ObjectPose | None) -> pinograsp.Scene:
    """Return a scene with an object elsewhere, if the command line says so.

    Args:
        scene: the scene.
        object_pose: name of an object, its position, m, and its roll, pitch and yaw, rad.

    Raises:
        InputError: there is no such object, or a number is not finite.
    """
    if object_pose is None:
        return scene
    name, x, y, z, *rpy = object_pose
    keys = [f"{key}[{index}]" for key in ("position", "rpy") for index in range(3)]
    with as_options({key: f"--object-pose {axis}" for key, axis in zip(keys, POSE, strict=True)}):
        pose = pinograsp.Pose(position=(x, y, z), rpy=(rpy[0], rpy[1], rpy[2]))
    return scene.with_object_pose(name, pose)


def read_robot(name: str) -> pinograsp.Robot:
    """Return a robot; a robot file that cannot be used is found before any library of robots is loaded.

    Raises:
        InputError: a file is missing or wrong.
    """
    from ..descriptions import load_robot_description

    description = load_robot_description(name)
    return pinograsp.Robot(description)


def read_result(file: Path, terminal: Terminal) -> pinograsp.Result:
    """Return the result in a file; of one that was changed since it was written, warn.

    Raises:
        FileError: the file is missing, is damaged, or is no result.
    """
    result = pinograsp.read_json(file)
    if result.altered:
        from ..results.result import ALTERED

        terminal.warn(f"{file}: this result may be wrong: {ALTERED}")
    return result


def grasp_of(result: pinograsp.Result, number: int, file: Path) -> pinograsp.Grasp:
    """Return a grasp by its number in the file, from 1.

    Raises:
        InputError: there is none of this number.
    """
    count = len(result.grasps)
    if not 1 <= number <= count:
        there = f"there are {count}, numbered from 1" if count else "there is none"
        raise InputError(f"no grasp {number}: {there}", file=file, key="--grasp")
    return result.grasps[number - 1]
