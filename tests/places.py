"""Points of problems at which tests look: starts, projected starts, grasps."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from conftest import Array

from pinograsp.collision.batch_clearance import BatchClearance
from pinograsp.collision.scene_world import enclosure_world
from pinograsp.descriptions import Scene
from pinograsp.kinematics.hand_posture import preshape
from pinograsp.problem import GraspProblem, State, TaskModel
from pinograsp.solve.options import Projection
from pinograsp.solve.projection import initial_guesses, nearest_assignment


def changed(scene: Scene, section: str, name: str = "sphere", **keys: Any) -> Scene:
    """Return the scene with keys of one object or task replaced."""
    content = scene.model_dump()
    content[section][name] |= keys
    return Scene.model_validate(content)


@dataclass(frozen=True)
class Place:
    """A point of a problem."""

    problem: GraspProblem
    x: Array

    @property
    def state(self) -> State:
        return self.problem.state(self.x)


@functools.cache
def random_starts(model: TaskModel, count: int, seed: int) -> Array:
    """Return postures free of collision with the wrist near the object, the hand opened for the desired points."""
    normals = -model.object_surface(model.desired_points)[1]
    robot, synergies = model.robot, preshape(model.robot, model.desired_points, normals)
    low, high = np.maximum(robot.lower[:-1], -math.pi), np.minimum(robot.upper[:-1], math.pi)
    q = np.random.default_rng(seed).uniform(low, high, (30_000, len(low)))
    clearance = BatchClearance(robot, enclosure_world(robot, model.scene, model.task.margin), synergies)
    positions, _ = clearance.kinematics.wrist(clearance.kinematics.frames(q))
    q = q[np.linalg.norm(positions - model.load.center_of_mass, axis=1) < 0.3]
    q = q[clearance.measure(q)[0]][:count]
    return np.column_stack([q, np.tile(synergies, (len(q), 1))])


def project(problem: GraspProblem, x: Array, onto: Projection) -> Array:
    """Return the first point to solve from."""
    return next(initial_guesses(problem, x, onto))


@functools.cache
def first_grasp(sphere_task: TaskModel) -> Place:
    """Return a grasp of the sphere at the desired points: the first projected start that keeps every constraint."""
    for posture in random_starts(sphere_task, 20, 0):
        x = np.concatenate([posture, np.zeros(4)])
        problem = GraspProblem(sphere_task, (0, 1))
        problem = GraspProblem(sphere_task, nearest_assignment(sphere_task, problem.state(x)))
        x = project(problem, x, "contacts and clearance")
        if problem.evaluate(x).violation < 1e-4:
            return Place(problem, x)
    raise AssertionError("no start leads to a grasp")
