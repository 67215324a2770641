"""Forces, V and q_r of plans beside another formulation of the force problem, solved by another solver.

The grasps come from plans; everything else is built anew from the result: Jacobians from the verification's kinematics,
the hand as springs, V as power cones. The optimiser eliminates the balance, finds a basis of the active internal forces
and minimises the barrier by Newton's method; here the unknowns are how far the synergies' references move, ds, and how
far the object yields, u, and the balance is a constraint:

    minimise    sum_k t_k
    subject to  f = K (J S ds - G^T u),  w + G f = 0
                t_k >= 1 / (2 s_k^2)                 power cone: t^(1/3) s^(2/3) >= 2^(-1/3)
                s <= n . F - alpha norm(F, m / e),  s <= n . F - f_min,  s <= f_max - norm(F)     for every contact

The minimum of V is flat: a program that is right to 1e-10 in V is so to 1e-5 in f. The last digits come from a root of
the gradient of V along the forces that the constraints leave free.
"""

from __future__ import annotations

import functools
import math
from typing import Any

import clarabel
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import linalg, optimize, sparse

import pinograsp
from pinograsp.descriptions import Scene, robot_for
from pinograsp.descriptions.hand import SoftFinger
from pinograsp.geometry.filled import center_of_mass_world
from pinograsp.verification.jacobians import jacobian
from pinograsp.verification.robot import read_robot

Array = NDArray[np.float64]
HARD = {"model": "hard_finger"}
SOFT = {"model": "soft_finger", "torsion_radius": 0.006, "torsional_stiffness": 0.5}
CASES = [
    ("gen3_2f85", "glovebox", "sphere", HARD),
    ("gen3_2f85", "glovebox_can", "can", SOFT),
    pytest.param("gen3_2f85_paper", "glovebox_can", "can", HARD, marks=pytest.mark.slow),
    pytest.param("xarm7_allegro", "allegro_ceiling", "sphere", HARD, marks=pytest.mark.slow),
    pytest.param("xarm7_allegro", "allegro_ceiling", "sphere", SOFT, marks=pytest.mark.slow),
]


class Springs:
    """The hand about one grasp: G (torques about the centre of mass over 50 mm), J S, K and which rows are what."""

    def __init__(self, grasp: Any) -> None:
        setup = grasp.setup
        robot = robot_for(setup.robot, setup.scene, setup.task)
        self.task = setup.scene.task(setup.task)
        read = read_robot(setup.robot)
        kinematics = read.kinematics.mounted(setup.scene.mounting.matrix)
        rates = read.synergies.rates(kinematics.joints)
        poses = kinematics.poses(grasp.joints)
        center = center_of_mass_world(setup.scene.objects[self.task.object])
        G, J, self.compliance, self.parts = [], [], [], []
        self.names = list(rates)
        self.S = np.array(list(rates.values()))
        for pad, contact in zip(robot.pads, grasp.contacts, strict=True):
            n = -contact.normal
            soft = isinstance(pad.contact, SoftFinger)
            of_hand = [twist for twist in kinematics.twists(pad.link, poses) if twist.joint in rates]
            at = np.zeros((6, len(rates)))
            at[:, [self.names.index(twist.joint) for twist in of_hand]] = jacobian(of_hand, contact.point)
            rows = len(self.compliance) + np.arange(3)
            self.parts.append(
                (rows, rows[-1] + 1 if soft else None, n, pad.contact.torsion_radius if soft else math.inf)
            )
            J += [*at[:3]]
            G += [np.concatenate([axis, np.cross(contact.point - center, axis) / 0.05]) for axis in np.eye(3)]
            self.compliance += 3 * [1.0 / setup.robot.stiffness.contact]
            if soft:
                J.append(n @ at[3:])
                G.append(np.concatenate([np.zeros(3), n / 0.05]))
                self.compliance.append(1.0 / pad.contact.torsional_stiffness)
        self.G, self.J = np.array(G).T, np.array(J)
        flexible = np.diag(self.compliance) + self.J @ self.J.T / setup.robot.stiffness.joint
        self.K = np.linalg.inv(flexible)
        wrench = self.task.wrench.vector
        self.w = np.concatenate([wrench[:3], wrench[3:] / 0.05])

    def forces(self) -> tuple[Array, float]:
        """Return f and V of the convex program."""
        c, constants = self.G.shape[1], self.task.contact
        springs = linalg.orth(self.K @ np.hstack([self.J @ self.S, self.G.T]), rcond=1e-10)  # what f can be
        count = 3 * len(self.parts)
        size = springs.shape[1] + 2 * count
        f = np.hstack([springs, np.zeros((c, 2 * count))])
        s, t = (np.eye(size)[springs.shape[1] + first * count :][:count] for first in (0, 1))
        alpha = math.cos(math.atan(constants.friction))
        balance = linalg.orth(self.G, rcond=1e-9).T
        rows, sides, cones = [balance @ self.G @ f], [-balance @ self.w], [clarabel.ZeroConeT(len(balance))]
        for i, (force, spin, n, e) in enumerate(self.parts):
            pressing = n @ f[force]
            sharing = [*f[force], *([] if spin is None else [f[spin] / e])]
            rows += [-(pressing - s[3 * i])[None], *[-alpha * row[None] for row in sharing]]
            rows += [s[3 * i + 2][None], *[-row[None] for row in f[force]], (s[3 * i + 1] - pressing)[None]]
            sides += [np.zeros(1 + len(sharing)), [constants.max_force, 0.0, 0.0, 0.0, -constants.min_normal_force]]
            cones += [
                clarabel.SecondOrderConeT(1 + len(sharing)),
                clarabel.SecondOrderConeT(4),
                clarabel.NonnegativeConeT(1),
            ]
        for k in range(count):
            rows.append(-np.vstack([t[k], s[k], np.zeros(size)]))
            sides.append([0.0, 0.0, 0.5 ** (1 / 3)])
            cones.append(clarabel.PowerConeT(1 / 3))
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
        settings.reduced_tol_gap_abs = settings.reduced_tol_gap_rel = settings.reduced_tol_feas = 1e-8
        A, q = sparse.csc_matrix(np.vstack(rows)), t.sum(axis=0)
        P = sparse.csc_matrix((size, size))
        solution = clarabel.DefaultSolver(P, q, A, np.concatenate(sides), cones, settings).solve()
        assert solution.status in (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)
        x = np.array(solution.x)
        # Where 1 / (2 s^2) ends and (A6) becomes a parabola, the program would be another one.
        assert (s @ x).min() > constants.kappa
        exact = self.polished(f @ x, springs @ linalg.null_space(balance @ self.G @ springs, rcond=1e-9))
        return exact, float(q @ x)

    def polished(self, f: Array, free: Array) -> Array:
        """Return the forces near f, in the free directions (columns), where the gradient of V vanishes."""
        constants = self.task.contact
        alpha = math.cos(math.atan(constants.friction))

        def gradient(z: Array) -> Array:
            at = f + free @ z
            slope = np.zeros(len(at))
            for force, spin, n, e in self.parts:
                F, m = at[force], 0.0 if spin is None else at[spin]
                pressing, size, sharing = n @ F, np.linalg.norm(F), math.hypot(np.linalg.norm(F), m / e)
                for s, rise in (
                    (pressing - alpha * sharing, n - alpha * F / sharing),
                    (pressing - constants.min_normal_force, n),
                    (constants.max_force - size, -F / size),
                ):
                    slope[force] -= rise / s**3
                if spin is not None:
                    slope[spin] += alpha * m / e**2 / sharing / (pressing - alpha * sharing) ** 3
            return free.T @ slope

        z = optimize.root(gradient, np.zeros(free.shape[1]), tol=1e-14).x
        assert np.abs(gradient(z)).max() < 1e-10
        assert np.abs(free @ z).max() < 1e-3
        return f + free @ z

    def references(self, f: Array) -> dict[str, float]:
        """Return how far the hand's joints are bent beyond contact for forces f: the least that ds can be."""
        others = linalg.null_space((self.K @ self.G.T).T, rcond=1e-9).T
        ds = np.linalg.lstsq(others @ self.K @ self.J @ self.S, others @ f, rcond=1e-9)[0]
        return dict(zip(self.names, (self.S @ ds).tolist(), strict=True))


@functools.cache
def grasps(robot: str, scene: str, task: str, soft: bool) -> tuple[Any, ...]:
    content = pinograsp.load_scene(scene).model_dump()
    content["tasks"][task]["contact_model"] = SOFT if soft else HARD
    changed = Scene.model_validate(content)
    return pinograsp.plan(pinograsp.load_robot(robot), changed, task, starts=4, workers=1).grasps


@pytest.mark.parametrize(("robot", "scene", "task", "contact"), CASES)
def test_forces_and_references_of_plans(robot: str, scene: str, task: str, contact: dict[str, Any]) -> None:
    found = grasps(robot, scene, task, contact is SOFT)
    assert len(found) >= 2
    for grasp in found[:3]:
        springs = Springs(grasp)
        f, V = springs.forces()
        assert abs(grasp.cost.V / V - 1.0) < 1e-9
        for (force, spin, _, _), reported in zip(springs.parts, grasp.contacts, strict=True):
            np.testing.assert_allclose(reported.force, f[force], atol=1e-8)
            assert reported.spin_torque == pytest.approx(0.0 if spin is None else f[spin], abs=1e-10)
        bent = {name: grasp.q_r[name] - grasp.joints[name] for name in grasp.q_r}
        assert bent == pytest.approx({name: springs.references(f)[name] for name in bent}, abs=1e-8)
