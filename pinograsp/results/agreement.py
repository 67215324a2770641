"""What the parts of a result say of each other: lengths and names that belong together, references, sums.

A rule is a function of a result, or of a grasp of it, and an entry of `RULES` or `GRASP_RULES`. Only what follows from
the file alone is looked at, and quickly; `reverify` recomputes the rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from ..arrays import Array
from ..descriptions import robot_for
from ..descriptions.hand import HardFinger
from ..descriptions.mesh_files import content_hashes
from ..errors import InputError, close_names
from .grasp import Grasp
from .result import Result
from .setup import Setup

Disagreement = tuple[str, str]
"""Key path and what is wrong there."""
RELATIVE, ABSOLUTE = 1e-9, 1e-12
"""Two numbers are the same if they are this near to each other, in any unit."""
RIGID = 1e-6
"""How far a rotation may be from a rotation, and a normal from length 1."""


def first_disagreement(result: Result) -> Disagreement | None:
    """Return the first thing that does not fit the rest; None if all does."""
    with np.errstate(all="ignore"):  # numbers that are too great fit nothing
        return next(_disagreements(result), None)


def _disagreements(result: Result) -> Iterator[Disagreement]:
    for rule in RULES:
        yield from rule(result)
    grasps = [(f"grasps[{index}]", grasp) for index, grasp in enumerate(result.grasps)]
    missed = None if result.explanation is None else result.explanation.nearest_miss
    for name, grasp in [*grasps, ("explanation.nearest_miss", missed)] if missed else grasps:
        for grasp_rule in GRASP_RULES:
            for key, problem in grasp_rule(grasp, result):
                yield f"{name}.{key}", problem


def _references(result: Result) -> Iterator[Disagreement]:
    """Task, pads and joints are there under the names by which they are called."""
    setup = result.setup
    if setup.task not in setup.scene.tasks:
        yield "setup.task", f"the scene has no task {setup.task!r}"
        return
    try:
        robot_for(setup.robot, setup.scene, setup.task)
    except InputError as error:
        yield f"setup.scene.{error.key}", error.problem
    known = [*setup.robot.arm.joints, *(synergy.label for synergy in setup.robot.hand.synergies)]
    for interval in setup.scene.tasks[setup.task].intervals:
        if interval.name not in known:
            key = f"setup.scene.tasks.{setup.task}.{interval.key}.{interval.name}"
            yield key, f"the robot has no arm joint or synergy of this name. {close_names(interval.name, known)}"


def _hashes(result: Result) -> Iterator[Disagreement]:
    """Hold the hashes of files against those that robot and scene state of themselves."""
    stated, setup = result.provenance.get("sha256", {}), result.setup
    if stated:
        own = {
            name: (f"`setup.{name}`", part.digest) for name, part in (("robot", setup.robot), ("scene", setup.scene))
        }
        own |= {name: (f"`setup.scene.{name}`", sha256) for name, sha256 in content_hashes(setup.scene).items()}
        for name, (of, digest) in own.items():
            if stated.get(name) != digest:
                yield f"provenance.sha256.{name}", f"{of} has {digest}"


def _sums(result: Result) -> Iterator[Disagreement]:
    """No more starts ended in some way than there are."""
    feasible = result.counts.get("converged", 0) + result.counts.get("feasible", 0)
    without = sum(blocked.starts for blocked in result.blocked.values())
    found = sum(grasp.count for grasp in result.grasps)
    for key, number, most, of in (
        ("counts", result.done, result.starts, "starts"),
        ("verified", result.verified + result.refuted, feasible, "starts that ended feasible"),
        ("blocked", result.verified + without, result.done, "starts that were solved, less those verified,"),
        ("grasps", found, result.verified, "starts verified"),
    ):
        if number > most:
            yield key, f"{number} are more than the {most} {of}"


def _alike(result: Result) -> Iterator[Disagreement]:
    """All grasps have the same joints in the same order, as many forces, and figures but for those of resistance."""
    starts: set[int] = set()
    for index, grasp in enumerate(result.grasps):
        for key, own, first in zip(
            ("joints", "q_r", "internal_forces", "certificate.figures"),
            _layout(grasp),
            _layout(result.grasps[0]),
            strict=True,
        ):
            if own != first:
                yield f"grasps[{index}].{key}", "is laid out otherwise than in the first grasp"
        if grasp.start is None or not grasp.start < result.starts or grasp.start in starts:
            problem = f"a start of its own below the number of starts, {result.starts}, is wanted"
            yield f"grasps[{index}].start", f"{problem} (given: {grasp.start})"
        else:
            starts.add(grasp.start)


def _layout(grasp: Grasp) -> tuple[object, ...]:
    figures = [(figure.name, figure.unit, figure.sense) for figure in grasp.certificate.figures]
    proofs = [figure for figure in figures if not figure[0].startswith("Q_")]  # an interrupt leaves these out
    return list(grasp.joints), list(grasp.q_r), len(grasp.internal_forces), proofs


def _proven(grasp: Grasp, result: Result) -> Iterator[Disagreement]:
    """Ask that a grasp was found by a start at least."""
    if grasp.count < 1:
        yield "count", "1 or more is wanted (given: 0)"


def _joints(grasp: Grasp, result: Result) -> Iterator[Disagreement]:
    """Arm joints, synergies and reference angles are those of the robot, and the same wherever they stand."""
    robot = result.setup.robot
    own = {name: ("q_arm", index, grasp.q_arm) for index, name in enumerate(robot.arm.joints)}
    labels = [synergy.label for synergy in robot.hand.synergies]
    single = {synergy.joint for synergy in robot.hand.synergies}
    own |= {name: ("synergy", index, grasp.synergy) for index, name in enumerate(labels) if name in single}
    yield from _count("q_arm", grasp.q_arm, len(robot.arm.joints), "arm joints of the robot")
    yield from _count("synergy", grasp.synergy, len(labels), "synergies of the robot")
    for name in (*robot.arm.joints, *sorted(robot.hand.joints)):
        if name not in grasp.joints:
            yield "joints", f"{name!r} of the robot is missing"
    for name, (key, index, values) in own.items():
        if name in grasp.joints and index < len(values) and not _same(values[index], grasp.joints[name]):
            yield f"{key}[{index}]", f"is not joints.{name}, {grasp.joints[name]!r}"
    for name in grasp.q_r:
        if name not in grasp.joints or name in robot.arm.joints:
            yield f"q_r.{name}", "is no joint of the hand"


def _pads(grasp: Grasp, result: Result) -> Iterator[Disagreement]:
    """There is a contact for each pad of the task, in their order, with as many parameters as its patch has."""
    setup = result.setup
    pads = robot_for(setup.robot, setup.scene, setup.task).pads
    yield from _count("contacts", grasp.contacts, len(pads), "pads of the task")
    parameters = sum(len(pad.patch.parameters) for pad in pads)
    yield from _count("contact_parameters", grasp.contact_parameters, parameters, "parameters of the pads")
    for index, (contact, pad) in enumerate(zip(grasp.contacts, pads, strict=False)):
        for key, own, wanted in (("pad", contact.pad, pad.name), ("link", contact.link, pad.link)):
            if own != wanted:
                yield f"contacts[{index}].{key}", f"{wanted!r} is wanted: pads are in the order of the task"
        if isinstance(pad.contact, HardFinger) and contact.spin_torque != 0.0:
            yield f"contacts[{index}].spin_torque", "a hard finger transmits none"


def _frames(grasp: Grasp, result: Result) -> Iterator[Disagreement]:
    """Poses are rigid and normals of length 1."""
    if not _rigid(grasp.T_world_wrist):
        yield "T_world_wrist", "is no pose"
    for index, contact in enumerate(grasp.contacts):
        if not _rigid(contact.T_world_pad):
            yield f"contacts[{index}].T_world_pad", "is no pose"
        if not abs(math.hypot(*contact.normal) - 1.0) <= RIGID:
            yield f"contacts[{index}].normal", "its length is not 1"


def _desired(grasp: Grasp, result: Result) -> Iterator[Disagreement]:
    """Each contact serves a desired point of the task, and none of them twice."""
    remaining = desired_points(result.setup)
    for index, contact in enumerate(grasp.contacts):
        stated, key = contact.desired_point, f"contacts[{index}].desired_point"
        if not remaining:
            if stated is not None:
                yield key, "the task desires none, or no further one"
            continue
        near = [k for k, point in enumerate(remaining) if stated is not None and _same(stated, point)]
        if near:
            remaining.pop(near[0])
        else:
            yield key, "is no desired contact of the task that is left"


def _cost(grasp: Grasp, result: Result) -> Iterator[Disagreement]:
    """U and Phi follow from contact points, desired points and V (10)."""
    cost, pairs = grasp.cost, [(contact.point, contact.desired_point) for contact in grasp.contacts]
    phi_mm2 = sum(1e6 * float(((point - desired) ** 2).sum()) for point, desired in pairs if desired is not None)
    U = cost.phi_mm2 + result.setup.scene.task(result.setup.task).force_weight * cost.V
    for key, stated, follows in (("phi_mm2", cost.phi_mm2, phi_mm2), ("U", cost.U, U)):
        if not _same(stated, follows):
            yield f"cost.{key}", f"{follows!r} follows from the rest (given: {stated!r})"


def desired_points(setup: Setup) -> list[Array]:
    """Return the desired contact points of the task, world, m, shapes (3,); none if it desires none."""
    task = setup.scene.task(setup.task)
    T = setup.scene.objects[task.object].pose.matrix
    return [T[:3, :3] @ point + T[:3, 3] for point in np.array(task.desired_contacts or ()).reshape(-1, 3)]


def _count(key: str, parts: Sequence[object] | Array, wanted: int, of: str) -> Iterator[Disagreement]:
    if len(parts) != wanted:
        yield key, f"{wanted} are wanted, one for each of the {of} ({len(parts)} given)"


def _same(one: Array | float, other: Array | float) -> bool:
    return bool(np.allclose(one, other, RELATIVE, ABSOLUTE))


def _rigid(T: Array) -> bool:
    R = T[:3, :3]
    orthonormal = bool((abs(R.T @ R - np.eye(3)) <= RIGID).all()) and np.linalg.det(R) > 0.0
    return orthonormal and T[3].tolist() == [0.0, 0.0, 0.0, 1.0]


RULES: Sequence[Callable[[Result], Iterable[Disagreement]]] = (_references, _hashes, _sums, _alike)
"""Of the whole, in the order in which they rely on each other."""
GRASP_RULES: Sequence[Callable[[Grasp, Result], Iterable[Disagreement]]] = (
    *(_proven, _joints, _pads, _frames, _desired, _cost),
)
"""Of each grasp."""
