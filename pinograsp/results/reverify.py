"""A result recomputed from itself: its joints, contact points and forces prove the rest, or refute it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..descriptions import robot_for
from ..descriptions.mesh_keys import mesh_keys
from ..errors import InputError, require_kind, require_report
from ..frozen import Record
from ..progress import Progress, Report, no_report
from ..verification import Certificate
from ..verification.check import Verifier
from ..verification.resistance import is_graded
from .grasp import Contact, Cost, Grasp
from .provenance import file_hashes
from .ranking import default_order
from .result import WITHSTAND, Result
from .setup import Setup

RELATIVE, ABSOLUTE = 1e-9, 1e-12
"""Two numbers are the same if they are this near to each other, in any unit."""
SOLVED = 1e-5
"""The same for figures that an iterative solver computes, which another processor rounds otherwise, relative."""


@dataclass(frozen=True, eq=False, repr=False)
class Difference(Record):
    """A number or a word of a result that is not what follows from the rest of it."""

    grasp: int | None
    """Number of the grasp, from 1; None: of the result as a whole."""
    what: str
    """Its key in the file; figures go by their names and contacts by their pads."""
    stated: Any
    """Number or word in the result; None: nothing."""
    recomputed: Any
    """The same as it follows from the rest; None: nothing."""


def verify(result: Result, progress: Report = no_report) -> tuple[Difference, ...]:
    """Recompute every certificate of a result, and what else follows from joints, contact points and forces.

    Nothing but the result is used, and the URDF and the meshes that its robot names. Of a result that was read from a
    file any change is found, by the digest; of these also if the digest was made to fit:

    - every figure of the certificates;
    - U, Phi and V, arm joints, synergies, normals and desired points, pads and links;
    - the poses of the wrist and of the pads, and the order of the joints;
    - the order of the grasps and the numbers of starts;
    - the hashes of the robot's files.

    Args:
        result: from `plan` or `read_json`.
        progress: called after every grasp.

    Returns:
        All differences; none if everything stands.

    Raises:
        InputError: it is no result, or a file of the robot is missing or cannot be read.
    """
    require_kind("result", result, Result, remedy="Read it with `read_json`")
    require_report(progress)
    setup = result.setup
    with mesh_keys(setup.scene):
        found = list(_of_the_whole(result))
        verifier = Verifier(setup.robot, setup.scene, setup.task)
        for number, grasp in enumerate(result.grasps, 1):
            found += _of_grasp(number, grasp, setup, verifier)
            progress(Progress("certificates", number, len(result.grasps)))
    return tuple(found)


def _of_the_whole(result: Result) -> Iterator[Difference]:
    if result.altered:
        yield Difference(None, "content of the file", "unchanged", "changed since it was written")
    stated = dict(_leaves(result.provenance.get("sha256", {}), "provenance.sha256"))
    recomputed = dict(_leaves(file_hashes(result.setup.robot, result.setup.scene), "provenance.sha256"))
    yield from _differences(None, stated, recomputed)
    found = sum(grasp.count for grasp in result.grasps)
    feasible = result.counts.get("converged", 0) + result.counts.get("feasible", 0)
    weak = result.blocked[WITHSTAND].starts if WITHSTAND in result.blocked else 0
    sums = {
        "verified": (result.verified, found),
        "refuted": (result.refuted, feasible - found - weak),
        "sum of counts": (result.done, found + sum(blocked.starts for blocked in result.blocked.values())),
    }
    for what, (number, recounted) in sums.items():
        if number != recounted:
            yield Difference(None, what, number, recounted)
    yield from _of_the_order(result)
    if result.done > result.starts:
        yield Difference(None, "starts", result.starts, result.done)


def _of_the_order(result: Result) -> Iterator[Difference]:
    """Yield, of every two neighbours that stand the wrong way round, the one that is not in its place.

    U and figures are the stated ones: they are the recomputed ones, but for rounding errors, or differ themselves.
    """
    places = np.argsort(default_order(result.grasps))
    for index in np.flatnonzero(np.diff(places) < 0) + 1:
        index -= int(places[index] == index)
        yield Difference(int(index) + 1, "place in the list", int(index) + 1, int(places[index]) + 1)


def _of_grasp(number: int, grasp: Grasp, setup: Setup, verifier: Verifier) -> Iterator[Difference]:
    try:
        recomputed = _recomputed(grasp, setup, verifier)
    except InputError as error:
        yield Difference(number, "certificate", "verified", str(error))
        return
    stated, order = grasp.to_json(), list(recomputed.joints)
    if list(grasp.joints) != order:  # which JSON data that is compared by its keys does not show
        yield Difference(number, "order of joints", list(grasp.joints), order)
    stated["certificate"]["verified"] = True  # that is what a result holds
    yield from _differences(number, dict(_leaves(stated)), dict(_leaves(recomputed.to_json())))


def _recomputed(grasp: Grasp, setup: Setup, verifier: Verifier) -> Grasp:
    """Return the grasp that follows from the joints, contact points, forces and spin torques of another."""
    task, contacts = setup.scene.task(setup.task), grasp.contacts
    claim = grasp.claim
    certificate, derived = _certificate(grasp, verifier), verifier.derive(claim)
    desired = _desired_points(setup, contacts)
    offsets = [p - d for p, d in zip(claim.points, desired, strict=True) if d is not None]
    phi_mm2 = 1e6 * float((np.array(offsets) ** 2).sum())
    pads = robot_for(setup.robot, setup.scene, setup.task).pads
    return replace(
        grasp,
        joints={name: grasp.joints[name] for name in derived.joint_order},
        q_arm=np.array([grasp.joints[name] for name in setup.robot.arm.joints]),
        synergy=derived.synergies,
        cost=Cost(phi_mm2 + task.force_weight * derived.V, phi_mm2, derived.V),
        contacts=tuple(
            replace(contact, pad=pad.name, link=pad.link, normal=normal, desired_point=point, T_world_pad=T)
            for contact, pad, normal, point, T in zip(
                contacts, pads, derived.normals, desired, derived.T_world_pads, strict=True
            )
        ),
        certificate=certificate,
        T_world_wrist=derived.T_world_wrist,
    )


def _certificate(grasp: Grasp, verifier: Verifier) -> Certificate:
    """Return the certificate of a grasp; figures of resistance only if it has them: an interrupt leaves them out."""
    return verifier.certify(grasp.claim) if is_graded(grasp.certificate) else verifier.check(grasp.claim)


def _desired_points(setup: Setup, contacts: Sequence[Contact]) -> list[Array | None]:
    """Return the desired points of the task that the stated ones are nearest to, each once; world, m, shapes (3,).

    In a task that desires none, each is None.
    """
    task = setup.scene.task(setup.task)
    if task.desired_contacts is None:
        return [None] * len(contacts)
    T = setup.scene.objects[task.object].pose.matrix
    remaining = [T[:3, :3] @ point + T[:3, 3] for point in np.array(task.desired_contacts)]
    if len(remaining) != len(contacts):
        raise InputError(f"the task has {len(remaining)} desired contacts, the grasp {len(contacts)} contacts")
    found: list[Array | None] = []
    for contact in contacts:
        stated = contact.point if contact.desired_point is None else contact.desired_point
        nearest = int(np.argmin([np.linalg.norm(stated - other) for other in remaining]))
        found.append(remaining.pop(nearest))
    return found


def _leaves(data: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the numbers and words in JSON data by key path, `certificate.figures.friction.value`."""
    if isinstance(data, Mapping):
        parts = data.items()
    elif isinstance(data, list):
        parts = _labelled(data).items()
    else:
        yield key, data
        return
    for name, part in parts:
        yield from _leaves(part, f"{key}.{name}" if key else str(name))


def _labelled(parts: list[Any]) -> dict[str, Any]:
    """Return parts by name, pad or index; a name that another one had before gets the index, so that none is lost."""
    found: dict[str, Any] = {}
    for index, part in enumerate(parts):
        label = str(part.get("name") or part.get("pad") or index) if isinstance(part, dict) else str(index)
        found[label if label not in found else f"{label} ({index})"] = part
    return found


def _differences(number: int | None, stated: dict[str, Any], recomputed: dict[str, Any]) -> Iterator[Difference]:
    for what in stated | recomputed:
        one, other = stated.get(what), recomputed.get(what)
        if not _same(one, other, SOLVED if ".Q_" in what else RELATIVE):
            yield Difference(number, what, one, other)


def _same(one: Any, other: Any, relative: float) -> bool:
    if isinstance(one, int | float) and isinstance(other, int | float):
        return math.isclose(one, other, rel_tol=relative, abs_tol=ABSOLUTE)
    return bool(one == other)
