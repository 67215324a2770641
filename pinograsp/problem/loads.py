"""Checks that the contacts can carry the load: whatever the grasp, and at the desired contacts."""

from __future__ import annotations

import math

import numpy as np

from ..errors import TaskError
from ..kinematics.hand_posture import always_parallel
from ..mechanics import carried, greatest_force, greatest_force_parallel, greatest_torque
from .task_model import TaskModel

ROUNDING = 1e-3
"""Part of a load that is let pass."""


def check_load(model: TaskModel) -> list[str]:
    """Refuse a load that no grasp carries; return what is odd about it at the desired contacts, in words.

    Raises:
        TaskError: the external force or torque is above what so many contacts carry within friction and force limit.
    """
    if not model.task.balance_wrench:
        return []
    force, most, why = float(np.linalg.norm(model.load.wrench[:3])), *_most_carried(model)
    if force > (1.0 + ROUNDING) * most:
        limit, key = model.limits.maximum, _load_key(model)
        load = f"a load of less than {_down(most):g} N"
        if model.task.wrench is None:
            load = f"a mass of less than {_down(most / float(np.linalg.norm(model.scene.gravity))):g} kg"
        raise TaskError(
            f"{why} carry less than {most:.4g} N (max_force {limit:g} N, friction {model.limits.friction:g}), "
            f"the load is {force:.4g} N",
            file=model.scene.source,
            key=key,
            remedy=f"Give {load}, or a `contact.max_force` of more than {_up(limit * force / most):g} N",
        )
    _check_torque(model)
    return _at_desired_contacts(model, force)


def _check_torque(model: TaskModel) -> None:
    torque = float(np.linalg.norm(model.load.wrench[3:]))
    most = greatest_torque(model.contact_models, model.limits, model.load.rho)
    if torque > (1.0 + ROUNDING) * most:
        limit = model.limits.maximum
        raise TaskError(
            f"{len(model.robot.pads)} contacts on the object carry a torque of less than {most:.4g} N m about its "
            f"centre of mass (max_force {limit:g} N), the load is {torque:.4g} N m",
            file=model.scene.source,
            key=f"tasks.{model.task_name}.wrench",
            remedy=f"Give a torque of less than {_down(most):g} N m, or a `contact.max_force` of more than "
            f"{_up(limit * torque / most):g} N",
        )


def _down(value: float) -> float:
    """Return a value rounded down to three digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / unit * (1.0 + 1e-12)) * unit:.3g}")


def _up(value: float) -> float:
    """Return a value rounded up to three digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.ceil(value / unit * (1.0 - 1e-12)) * unit:.3g}")


def _most_carried(model: TaskModel) -> tuple[float, str]:
    """Return the greatest force that a grasp may carry, N, and what carries it."""
    count = len(model.robot.pads)
    if always_parallel(model.robot) and not model.surface.uneven:  # pads that lie on facets are tilted a little
        return greatest_force_parallel(model.limits), "two pads that are parallel"
    return greatest_force(count, model.limits), f"{count} contacts"


def _load_key(model: TaskModel) -> str:
    """Return the key of the scene that says how large the load is."""
    if model.task.wrench is None:
        return f"objects.{model.task.object}.mass"
    return f"tasks.{model.task_name}.wrench"


def _at_desired_contacts(model: TaskModel, force: float) -> list[str]:
    """Return what the desired contacts do not carry; contacts elsewhere may."""
    if not len(model.desired_points) or not np.any(model.load.wrench):
        return []
    points, normals = model.desired_points - model.load.center_of_mass, -model.felt_normals(model.desired_points)
    factor = carried(points, normals, model.contact_models, model.limits, model.load.wrench)
    if factor is None or factor >= 1.0 - ROUNDING:
        return []
    part = f"{factor * force:.2g} N" if factor > ROUNDING else "nothing"
    load = f"{part} of the {force:.3g} N" if force else f"{100 * factor:.0f} % of the torque"
    remedy = "move them (over or under the centre of mass), or give more `contact.max_force` or friction"
    return [f"at the desired contacts forces within friction and force limits carry {load}: {remedy}"]
