"""Statics, V and its minimiser, and their derivatives, on contacts made by hand."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from pinograsp.arrays import skew
from pinograsp.mechanics import (
    ContactDerivatives,
    ContactModels,
    Contacts,
    ForceLimits,
    Hand,
    Load,
    Statics,
    force_cost_gradient,
    grasp_statics,
    residual_gradient,
    solve_forces,
)
from pinograsp.mechanics.barrier import barrier, penalty, reduced_barrier, reduced_value

Array = NDArray[np.float64]

LIMITS = ForceLimits(friction=0.9, minimum=0.001, maximum=5.0, kappa=0.01)
RADIUS = 0.04
HARD = ContactModels.hard(2, 1e4)
JAW_Y = np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
WEIGHT = np.array([2.0, 0.0, 0.0, 0.0, 0.0, 0.0])
SEEDS = st.integers(0, 2**32 - 1)


def two_fingers(
    models: ContactModels = HARD, wrench: Array = WEIGHT, com: Array | None = None
) -> tuple[Statics, Array]:
    """Return the statics of two contacts across y, each finger a slider along y, and the normals."""
    points = -RADIUS * JAW_Y
    jacobians = np.zeros((2, 6, 2))
    jacobians[0, :3, 0], jacobians[1, :3, 1] = JAW_Y
    hand = Hand(np.ones((2, 1)), np.full(2, 0.01))
    load = Load(np.zeros(3) if com is None else com, wrench, RADIUS)
    return grasp_statics(Contacts(points, JAW_Y, jacobians), models, hand, load), JAW_Y


def constraint_values(f: Array, normals: Array, models: ContactModels, limits: ForceLimits) -> Array:
    """Return sigma_f, sigma_m, sigma_M of every contact, N, shape (3, n)."""
    forces = models.forces(f)
    square = (forces * forces).sum(axis=1) + 1e-24  # N^2
    friction_norm = np.sqrt(square + (models.spins(f) * models.rows.inverse_radius) ** 2)
    normal_force = (forces * normals).sum(axis=1)
    return np.stack(
        [
            limits.alpha * friction_norm - normal_force,
            limits.minimum - normal_force,
            np.sqrt(square) - limits.maximum,
        ]
    )


# ---- numbers of the paper


@pytest.mark.paper
def test_force_optimum_of_two_hard_fingers() -> None:
    """Assumes mu = 0.9, f_min = 0.001 N, f_max = 5 N on the norm, alpha = cos(atan mu), 2 N across the jaw axis."""
    statics, normals = two_fingers()
    solution = solve_forces(statics, normals, HARD, LIMITS)
    assert pytest.approx(2.1787, abs=5e-5) == solution.V
    np.testing.assert_allclose(solution.f, [-1.0, -3.6312, 0.0, -1.0, 3.6312, 0.0], atol=5e-5)


TABLE_5 = {
    1: ([-1.000, -3.631, 0.000, -0.999, 3.631, -0.000], 2.178),
    2: ([-0.985, -3.630, 0.092, -1.014, 3.630, -0.092], 2.182),
    4: ([-0.840, -3.630, -0.029, -1.159, 3.630, 0.029], 2.199),
}


@pytest.mark.paper
@pytest.mark.parametrize("case", TABLE_5)
def test_V_of_the_printed_forces(case: int) -> None:
    """Table 5, the normals taken exactly along base y, the jaw axis. The paper prints V 2.178, 2.181, 2.198."""
    f, V = TABLE_5[case]
    assert pytest.approx(V, abs=1e-3) == barrier(np.array(f), JAW_Y, HARD, LIMITS).V


@pytest.mark.paper
def test_the_printed_alpha_and_f_max_do_not_give_the_printed_V() -> None:
    """alpha = 1 / (1 + mu^2) is that of another friction; f_max = 100 N moves the optimum to 72 N."""
    f = np.array(TABLE_5[1][0])
    printed_alpha = ForceLimits(math.sqrt((1 + 0.9**2) ** 2 - 1), 0.001, 5.0, 0.01)
    assert printed_alpha.alpha == pytest.approx(1 / (1 + 0.9**2))
    assert barrier(f, JAW_Y, HARD, printed_alpha).V < 1.2
    printed_maximum = ForceLimits(0.9, 0.001, 100.0, 0.01)
    statics, normals = two_fingers()
    solution = solve_forces(statics, normals, HARD, printed_maximum)
    assert pytest.approx(0.0044, abs=1e-4) == solution.V
    assert solution.f[4] == pytest.approx(72.0, abs=1.0)


def test_alpha_is_the_cosine_of_the_friction_angle() -> None:
    assert LIMITS.alpha == pytest.approx(math.cos(math.radians(41.987)), abs=1e-5)
    on_cone = np.array([0.9 * 2.0, -2.0, 0.0, 0.0, 2.0, 0.0])
    friction = constraint_values(on_cone, JAW_Y, HARD, LIMITS)[0]
    assert friction[0] == pytest.approx(0.0, abs=1e-12)
    assert friction[1] < -0.5


def paper_finger(q1: float, q2: float, base: float, q_c: float) -> tuple[Array, list[Array]]:
    """Return the contact point and the two joints of a planar finger (Table 3), in the finger plane, m."""
    shoulder = np.array([base, 0.0])
    knuckle = shoulder + 0.0573 * np.array([math.cos(q1), math.sin(q1)])
    along = np.array([math.cos(q1 + q2), math.sin(q1 + q2)])
    return knuckle + (0.0437 + q_c) * along, [shoulder, knuckle]


def paper_joints(sigma: float) -> Array:
    """Return (19): both fingers, distal phalanges parallel."""
    return np.array([sigma, math.pi / 2 - sigma, math.pi - sigma, sigma - math.pi / 2])


@pytest.mark.paper
@pytest.mark.parametrize(("sigma", "gap"), [(1.570, 25.2), (2.119, 84.98)])
def test_jaw_gap_of_the_printed_finger(sigma: float, gap: float) -> None:
    """Table 3 with the third joint at pi - sigma (the printed column repeats q_a,2); 25.2 mm between the bases."""
    q = paper_joints(sigma)
    (left, _), (right, _) = paper_finger(q[0], q[1], 0.0, 0.0), paper_finger(q[2], q[3], 0.0252, 0.0)
    assert 1e3 * (right[0] - left[0]) == pytest.approx(gap, abs=0.1)
    assert right[1] == pytest.approx(left[1])
    np.testing.assert_allclose([q[0] + q[1], q[2] + q[3]], math.pi / 2)


@pytest.mark.paper
def test_forces_and_reference_joints_of_simulation_2() -> None:
    """Compliance check of Sim 2: forces on the object and q_r.

    Assumed, since the text leaves it open: the planes of both fingers coincide; finger x points along the end
    effector's y (the jaw) and finger y along its z (the approach), so that contact 1 (left) presses along base -y;
    the axes are those of forward kinematics at Table 4's q_a; q_c is measured in mm from the tip of the distal
    phalanx, its zero, back to the knuckle; the centre of mass is midway between the contacts; y squeezes if
    positive, so that y = 5.111 N where Table 4 prints -5.111; w_e + G f = 0.
    """
    q = paper_joints(2.116)
    x = np.array([0.001, -1.0, 0.007])
    x /= np.linalg.norm(x)
    y = np.array([0.211, 0.007, 0.977])
    y -= x * (x @ y)
    y /= np.linalg.norm(y)
    R = np.column_stack([x, y, np.cross(x, y)])
    points, jacobians = np.zeros((2, 3)), np.zeros((2, 6, 4))
    for finger, (base, q_c) in enumerate([(0.0, -3.236e-3), (0.0252, -1.938e-3)]):
        point, joints = paper_finger(q[2 * finger], q[2 * finger + 1], base, q_c)
        points[finger] = R[:, :2] @ point
        for k, joint in enumerate(joints):
            lever = point - joint
            jacobians[finger, :3, 2 * finger + k] = R[:, :2] @ [-lever[1], lever[0]]
            jacobians[finger, 3:, 2 * finger + k] = R[:, 2]
    hand = Hand(np.array([[0.5], [-0.5], [-0.5], [0.5]]), np.full(4, 1 / 100.0))
    contacts = Contacts(points, np.array([x, -x]), jacobians)
    statics = grasp_statics(contacts, HARD, hand, Load(points.mean(axis=0), WEIGHT, 0.0423))
    np.testing.assert_allclose(statics.residual, 0.0, atol=1e-12)
    squeeze = np.array([5.111])
    f = statics.f_p + statics.E_s @ squeeze
    computed, printed = np.array([-0.985, -3.642, 0.082]), np.array([-0.985, -3.630, 0.092])
    assert np.linalg.norm(f[:3] - computed) < 0.003
    assert np.linalg.norm(f[:3] - printed) < 0.01 * np.linalg.norm(printed)
    np.testing.assert_allclose(f[:3] + f[3:], [-2.0, 0.0, 0.0], atol=1e-12)
    q_r = q + statics.reference_displacement(squeeze)
    np.testing.assert_allclose(q_r, [2.101, -0.531, 1.040, 0.531], atol=6e-4)
    np.testing.assert_allclose(q_r, [2.104, -0.534, 1.036, 0.534], atol=5e-3)


# ---- the penalty (A6) and V


@given(exponent=st.floats(-3.0, 0.0))
def test_penalty_is_twice_continuously_differentiable_at_the_switch(exponent: float) -> None:
    kappa = 10.0**exponent
    inside, outside = penalty(-kappa * (1 + 1e-12), kappa), penalty(-kappa, kappa)
    for left, right in zip(inside, outside, strict=True):
        np.testing.assert_allclose(left, right, rtol=1e-9)


@given(sigma=st.floats(-5.0, 5.0))
def test_penalty_derivatives(sigma: float) -> None:
    kappa, step = 0.5, 1e-5
    below, at, above = (penalty(sigma + k * step, kappa) for k in (-1, 0, 1))
    for order in (0, 1):
        slope = (above[order] - below[order]) / (2 * step)
        np.testing.assert_allclose(slope, at[order + 1], rtol=1e-6, atol=1e-4 if order else 1e-6)
    assert at[2] > 0.0


# ---- random grasps


@dataclass(frozen=True)
class Family:
    """Contacts that depend smoothly on x: quadratic points and Jacobians, normalised quadratic normals."""

    models: ContactModels
    hand: Hand
    load: Load
    point: tuple[Array, Array, Array]
    normal: tuple[Array, Array, Array]
    jacobian: tuple[Array, Array, Array]

    def at(self, x: Array) -> Contacts:
        normals = _quadratic(self.normal, x)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        return Contacts(_quadratic(self.point, x), normals, _quadratic(self.jacobian, x))

    def derivatives(self, x: Array) -> ContactDerivatives:
        length = np.linalg.norm(_quadratic(self.normal, x), axis=1)[:, None, None]
        normals = self.at(x).normals
        across = np.eye(3) - normals[:, :, None] * normals[:, None, :]
        return ContactDerivatives(
            _slope(self.point, x), across @ _slope(self.normal, x) / length, _slope(self.jacobian, x)
        )

    def statics(self, x: Array) -> Statics:
        return grasp_statics(self.at(x), self.models, self.hand, self.load)


def _quadratic(coefficients: tuple[Array, Array, Array], x: Array) -> Array:
    constant, linear, square = coefficients
    return np.asarray(constant + linear @ x + square @ x @ x)


def _slope(coefficients: tuple[Array, Array, Array], x: Array) -> Array:
    _, linear, square = coefficients
    return np.asarray(linear + (square + np.swapaxes(square, -1, -2)) @ x)


def random_family(seed: int, soft: tuple[bool, ...], synergies: int, torque: float = 0.02) -> Family:
    """Return fingers around a ball, about evenly spaced, each with two joints of its own and a shared one."""
    rng = np.random.default_rng(seed)
    n, variables = len(soft), 3
    angles = 2 * math.pi * np.arange(n) / n + rng.uniform(-0.3, 0.3, n)
    outward = np.stack([np.cos(angles), np.sin(angles), rng.uniform(-0.3, 0.3, n)], axis=1)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    inward = -outward + rng.normal(0.0, 0.15, (n, 3))
    h = 2 * n + 1
    jacobian = np.zeros((n, 6, h))
    for i in range(n):
        own = [2 * i, 2 * i + 1, h - 1]
        jacobian[i, :3, own] = 0.06 * rng.normal(size=(3, 3)) + np.array([0.08, 0.0, 0.0])[:, None] * inward[i]
        jacobian[i, 3:, own] = rng.normal(size=(3, 3))
    S = rng.normal(size=(h, synergies))
    S[:-1:2, 0] = 1.0  # the first synergy squeezes
    compliance: list[float] = []
    for is_soft in soft:
        compliance += [float(rng.uniform(0.5e-4, 2e-4))] * 3 + ([float(rng.uniform(0.5, 2.0))] if is_soft else [])
    force = rng.normal(size=3)
    load = Load(
        rng.normal(0.0, 0.005, 3),
        np.concatenate([2.0 * force / np.linalg.norm(force), torque * rng.normal(size=3)]),
        RADIUS,
    )

    def smooth(constant: Array, scale: float) -> tuple[Array, Array, Array]:
        linear = scale * rng.normal(size=(*constant.shape, variables))
        return constant, linear, 0.5 * scale * rng.normal(size=(*linear.shape, variables))

    return Family(
        ContactModels(np.where(soft, 0.006, 0.0), np.array(compliance)),
        Hand(S, rng.uniform(0.005, 0.02, h)),
        load,
        smooth(RADIUS * outward, 0.3 * RADIUS),
        smooth(inward, 0.3),
        smooth(jacobian, 0.02),
    )


FAMILIES = st.builds(
    random_family,
    seed=SEEDS,
    soft=st.lists(st.booleans(), min_size=2, max_size=4).map(tuple),
    synergies=st.integers(1, 3),
)
ORIGIN = np.zeros(3)


@given(family=FAMILIES)
def test_grasp_matrix_and_jacobian_are_those_of_their_definitions(family: Family) -> None:
    """G f sums forces and torques about the centre of mass; J^T f is the joint torque of the contact wrenches."""
    contacts, statics = family.at(ORIGIN), family.statics(ORIGIN)
    f = np.random.default_rng(0).normal(size=statics.G.shape[1])
    wrench, torques, row = np.zeros(6), np.zeros(len(statics.hand.joint_compliance)), 0
    for i, e in enumerate(family.models.torsion_radius):
        force, spin = f[row : row + 3], f[row + 3] * contacts.normals[i] if e else np.zeros(3)
        row += 4 if e else 3
        lever = contacts.points[i] - family.load.center_of_mass
        wrench += np.concatenate([force, (np.cross(lever, force) + spin) / RADIUS])
        torques += contacts.jacobians[i].T @ np.concatenate([force, spin])
    assert row == len(f)
    np.testing.assert_allclose(statics.G @ f, wrench, atol=1e-12)
    np.testing.assert_allclose(statics.J.T @ f, torques, atol=1e-12)


@given(family=FAMILIES)
def test_active_internal_forces(family: Family) -> None:
    statics = family.statics(ORIGIN)
    E, F = statics.E_s, statics.F_s
    internal = statics.G.shape[1] - np.linalg.matrix_rank(statics.G, tol=1e-8)
    assert E.shape[1] == min(internal, F.shape[1])
    np.testing.assert_allclose(statics.G @ F, 0.0, atol=1e-9 * np.abs(F).max())
    np.testing.assert_allclose(statics.G @ E, 0.0, atol=1e-9)
    # Orthonormal in newtons: spin torques divided by their radius.
    rows = family.models.rows
    newtons = np.ones(len(E))
    newtons[rows.spin[rows.spin >= 0]] = rows.inverse_radius[rows.spin >= 0]
    E_newtons, F_newtons = newtons[:, None] * E, newtons[:, None] * F
    np.testing.assert_allclose(E_newtons.T @ E_newtons, np.eye(E.shape[1]), atol=1e-9)
    np.testing.assert_allclose(E_newtons @ (E_newtons.T @ F_newtons), F_newtons, atol=1e-9 * np.abs(F_newtons).max())
    np.testing.assert_allclose(F @ statics.E_s_to_synergies, E, atol=1e-8)
    for squeeze in E.T:
        assert (family.at(ORIGIN).normals * family.models.forces(squeeze)).sum() >= 0.0


@given(family=FAMILIES, seed=SEEDS)
def test_forces_keep_balance_and_congruence(family: Family, seed: int) -> None:
    """For every y: G f = -P w, the rest perpendicular to range(G); C f = J S dsigma - G^T (a motion of the object)."""
    statics = family.statics(ORIGIN)
    y = np.random.default_rng(seed).normal(0.0, 3.0, statics.E_s.shape[1])
    f = statics.f_p + statics.E_s @ y
    G, w = statics.G, statics.load.scaled
    np.testing.assert_allclose(w + G @ f, statics.residual, atol=1e-8)
    np.testing.assert_allclose(G.T @ statics.residual, 0.0, atol=1e-8)
    compliance = statics.J * statics.hand.joint_compliance @ statics.J.T + np.diag(family.models.contact_compliance)
    moved = statics.J @ statics.reference_displacement(y) - compliance @ f
    twist, *_ = np.linalg.lstsq(G.T, moved, rcond=1e-10)
    np.testing.assert_allclose(G.T @ twist, moved, atol=1e-6 * np.abs(moved).max())


@given(family=FAMILIES, factors=st.lists(st.floats(0.01, 100.0), min_size=3, max_size=3))
def test_active_internal_forces_do_not_depend_on_the_scale_of_the_synergies(
    family: Family, factors: list[float]
) -> None:
    statics = family.statics(ORIGIN)
    S = family.hand.synergies
    scaled = Hand(S * np.array(factors)[: S.shape[1]], family.hand.joint_compliance)
    E, E_scaled = statics.E_s, grasp_statics(family.at(ORIGIN), family.models, scaled, family.load).E_s
    np.testing.assert_allclose(E @ E.T, E_scaled @ E_scaled.T, atol=1e-6)


@given(family=FAMILIES, seed=SEEDS)
def test_V_is_convex_in_y(family: Family, seed: int) -> None:
    statics, rng = family.statics(ORIGIN), np.random.default_rng(seed)
    normals = family.at(ORIGIN).normals

    def V(y: Array) -> float:
        return barrier(statics.f_p + statics.E_s @ y, normals, family.models, LIMITS).V

    a, b = rng.normal(0.0, 4.0, (2, statics.E_s.shape[1]))
    t = rng.uniform(0.05, 0.95)
    chord = (1 - t) * V(a) + t * V(b)
    assert V((1 - t) * a + t * b) <= chord * (1 + 1e-12)


@given(family=FAMILIES, seed=SEEDS)
def test_reduced_barrier_is_the_barrier(family: Family, seed: int) -> None:
    """Same V and slope as `barrier` at f_p + E y; its Hessian is the slope of its gradient."""
    statics, normals = family.statics(ORIGIN), family.at(ORIGIN).normals
    reduced = reduced_barrier(statics.f_p, statics.E_s, normals, family.models.rows, LIMITS.constants)
    y = np.random.default_rng(seed).normal(0.0, 4.0, statics.E_s.shape[1])
    V, gradient, hessian = reduced_value(reduced, y)
    full = barrier(statics.f_p + statics.E_s @ y, normals, family.models, LIMITS)
    assert pytest.approx(full.V, rel=1e-9) == V
    np.testing.assert_allclose(gradient, statics.E_s.T @ full.gradient, rtol=1e-7, atol=1e-9 * np.abs(gradient).max())
    slopes = [
        (reduced_value(reduced, y + d)[1] - reduced_value(reduced, y - d)[1]) / 2e-6 for d in 1e-6 * np.eye(len(y))
    ]
    np.testing.assert_allclose(np.array(slopes), hessian, atol=1e-4 * np.abs(hessian).max())


@given(family=FAMILIES, seed=SEEDS)
def test_barrier_gradients(family: Family, seed: int) -> None:
    statics, normals = family.statics(ORIGIN), family.at(ORIGIN).normals
    y = np.random.default_rng(seed).normal(0.0, 3.0, statics.E_s.shape[1])
    f = statics.f_p + statics.E_s @ y
    value = barrier(f, normals, family.models, LIMITS)
    numeric = differences(lambda v: barrier(v, normals, family.models, LIMITS).V, f)
    np.testing.assert_allclose(value.gradient, numeric, atol=1e-5 * np.abs(numeric).max())
    numeric = differences(lambda v: barrier(f, v.reshape(-1, 3), family.models, LIMITS).V, normals.ravel())
    np.testing.assert_allclose(value.normal_gradient.ravel(), numeric, atol=1e-5 * np.abs(numeric).max())


@given(family=FAMILIES, seed=SEEDS)
def test_y_is_the_minimiser(family: Family, seed: int) -> None:
    statics, normals = family.statics(ORIGIN), family.at(ORIGIN).normals
    solution = solve_forces(statics, normals, family.models, LIMITS)
    np.testing.assert_array_equal(solution.f, statics.f_p + statics.E_s @ solution.y)
    rng = np.random.default_rng(seed)
    for size in (1e-3, 1e-2, 0.1, 1.0, 5.0):
        step = rng.normal(size=len(solution.y))
        step *= size / np.linalg.norm(step)
        for y in (solution.y + step, solution.y - step):
            assert barrier(statics.f_p + statics.E_s @ y, normals, family.models, LIMITS).V > solution.V
    slope = statics.E_s.T @ solution.barrier.gradient
    assert np.abs(slope).max() <= 1e-5 * (1.0 + np.linalg.norm(solution.barrier.gradient))


@given(family=FAMILIES, seed=SEEDS)
def test_a_rigid_motion_of_everything_changes_nothing(family: Family, seed: int) -> None:
    rng = np.random.default_rng(seed)
    R, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    R *= np.sign(np.linalg.det(R))
    t = rng.normal(size=3)
    here, before = family.at(ORIGIN), family.statics(ORIGIN)
    turn = np.kron(np.eye(2), R)
    moved = Contacts(here.points @ R.T + t, here.normals @ R.T, turn @ here.jacobians)
    load = Load(R @ family.load.center_of_mass + t, turn @ family.load.wrench, family.load.rho)
    after = grasp_statics(moved, family.models, family.hand, load)
    old = solve_forces(before, here.normals, family.models, LIMITS)
    new = solve_forces(after, moved.normals, family.models, LIMITS)
    assert pytest.approx(old.V, rel=1e-6) == new.V
    assert np.linalg.norm(new.y) == pytest.approx(np.linalg.norm(old.y), rel=1e-4, abs=1e-6)
    np.testing.assert_allclose(
        family.models.forces(new.f), family.models.forces(old.f) @ R.T, atol=1e-4 * (1 + np.abs(old.f).max())
    )
    np.testing.assert_allclose(family.models.spins(new.f), family.models.spins(old.f), atol=1e-5)
    np.testing.assert_allclose(turn.T @ after.residual, before.residual, atol=1e-8)


# ---- the wrench that nothing balances


def test_torque_about_the_line_of_two_hard_fingers_is_not_balanced() -> None:
    torque = 0.06
    about_line, across = np.zeros(6), np.zeros(6)
    about_line[4], across[3] = torque, torque
    for wrench, left in (
        (WEIGHT, 0.0),
        (across, 0.0),
        (about_line, torque / RADIUS),
        (WEIGHT + about_line, torque / RADIUS),
    ):
        statics, _ = two_fingers(wrench=wrench)
        np.testing.assert_allclose(statics.residual, [0.0, 0.0, 0.0, 0.0, left, 0.0], atol=1e-12)
        assert np.linalg.matrix_rank(statics.G) == 5


def test_weight_beside_the_line_of_two_hard_fingers_is_not_balanced() -> None:
    """Centre of mass 3 mm beside the line, 2 N: 2 * 3 / 40 N of scaled torque about it, up to second order."""
    statics, _ = two_fingers(com=np.array([0.0, 0.0, 0.003]))
    assert np.linalg.norm(statics.residual) == pytest.approx(2.0 * 3.0 / 40.0, rel=1e-2)
    beside_along_the_force, _ = two_fingers(com=np.array([0.003, 0.0, 0.0]))
    np.testing.assert_allclose(beside_along_the_force.residual, 0.0, atol=1e-12)


def test_soft_fingers_resist_spin() -> None:
    soft = ContactModels(np.full(2, 0.006), np.array([1e-4, 1e-4, 1e-4, 1.0] * 2))
    statics, normals = two_fingers(soft, np.array([0.0, 0.0, 0.0, 0.0, 0.01, 0.0]))
    assert np.linalg.matrix_rank(statics.G) == 6
    np.testing.assert_allclose(statics.residual, 0.0, atol=1e-12)
    solution = solve_forces(statics, normals, soft, LIMITS)
    # normals are -y and y: the torques on the object sum to -0.01 N m about y
    np.testing.assert_allclose(soft.spins(solution.f), [0.005, -0.005], atol=1e-12)
    assert LIMITS.strict_cost > solution.V
    spin_only = constraint_values(solution.f, normals, soft, LIMITS)[0]
    force = soft.forces(solution.f)
    pressing = (force * normals).sum(axis=1)
    expected = LIMITS.alpha * np.hypot(np.linalg.norm(force, axis=1), 0.005 / 0.006) - pressing
    np.testing.assert_allclose(spin_only, expected, rtol=1e-9)


def test_a_hand_that_cannot_squeeze_has_no_internal_forces() -> None:
    """Both fingers move the same way: the hand pushes the object, e_s = 0, and V is that of f_p."""
    jacobians = np.zeros((2, 6, 1))
    jacobians[:, 1, 0] = 1.0
    hand, load = Hand(np.ones((1, 1)), np.array([0.01])), Load(np.zeros(3), WEIGHT, RADIUS)
    statics = grasp_statics(Contacts(-RADIUS * JAW_Y, JAW_Y, jacobians), HARD, hand, load)
    assert statics.E_s.shape == (6, 0)
    solution = solve_forces(statics, JAW_Y, HARD, LIMITS)
    assert solution.y.shape == (0,)
    assert solution.V == barrier(statics.f_p, JAW_Y, HARD, LIMITS).V > LIMITS.strict_cost
    np.testing.assert_array_equal(statics.reference_displacement(solution.y), [0.0])


@pytest.mark.parametrize("seed", range(40))
def test_a_hand_has_no_more_internal_forces_than_contacts_far_from_the_object_leave(seed: int) -> None:
    """Two soft fingers 1 m beside the centre of mass, three synergies: two columns, the third would be rounding."""
    family = random_family(seed, (True, True), 3)
    models = ContactModels(np.full(2, 0.0014), family.models.contact_compliance)
    load = replace(family.load, center_of_mass=family.load.center_of_mass + np.array([0.0, 0.0, 1.0]))
    contacts = family.at(ORIGIN)
    statics = grasp_statics(contacts, models, family.hand, load)
    assert statics.E_s.shape[1] == statics.E_s_to_synergies.shape[1] == 2
    assert math.isfinite(solve_forces(statics, contacts.normals, models, LIMITS).V)


def test_V_below_the_strict_cost_proves_every_limit() -> None:
    """At the edge, one sigma = -kappa alone makes V equal the strict cost."""
    V, _, _ = penalty(-LIMITS.kappa, LIMITS.kappa)
    assert pytest.approx(LIMITS.strict_cost) == V
    statics, normals = two_fingers()
    solution = solve_forces(statics, normals, HARD, LIMITS)
    assert LIMITS.strict_cost > solution.V
    assert (constraint_values(solution.f, normals, HARD, LIMITS) < -LIMITS.kappa).all()


# ---- derivatives


def differences(function: object, x: Array, step: float = 1e-6) -> Array:
    """Return central differences of a scalar function."""
    assert callable(function)
    return np.array([(function(x + d) - function(x - d)) / (2 * step) for d in step * np.eye(len(x))])


def V_star(family: Family, x: Array) -> float:
    return solve_forces(family.statics(x), family.at(x).normals, family.models, LIMITS).V


def check_gradients(family: Family, x: Array) -> tuple[int, float]:
    """Compare both gradients with differences; return e_s and the norm of the residual."""
    contacts, derivatives, statics = family.at(x), family.derivatives(x), family.statics(x)
    solution = solve_forces(statics, contacts.normals, family.models, LIMITS)
    gradient = force_cost_gradient(statics, contacts, derivatives, family.models, solution)
    numeric = differences(lambda v: V_star(family, v), x, 1e-5 if LIMITS.strict_cost > solution.V else 1e-6)
    np.testing.assert_allclose(gradient, numeric, rtol=0, atol=1e-5 * np.abs(numeric).max())
    norm = float(np.linalg.norm(statics.residual))
    if norm > 1e-6:
        gradient = residual_gradient(statics, derivatives, family.models)
        numeric = differences(lambda v: float(np.linalg.norm(family.statics(v).residual)), x)
        np.testing.assert_allclose(gradient, numeric, rtol=0, atol=1e-5 * np.abs(numeric).max())
    return solution.y.size, norm


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(
    ("soft", "synergies", "size"),
    [
        ((False, False), 1, 1),
        ((True, False), 1, 1),
        ((True, True), 2, 2),
        ((False, False, False), 1, 1),
        ((False, False, False), 2, 2),
        ((True, False, True), 2, 2),
        ((False, True, False, False), 3, 3),
    ],
)
def test_gradients_of_V_and_residual(soft: tuple[bool, ...], synergies: int, size: int, seed: int) -> None:
    """Two hard fingers leave part of the wrench unbalanced; V* is 1 to 1e9 over these grasps."""
    found, residual = check_gradients(random_family(seed, soft, synergies), np.array([0.05, -0.02, 0.03]))
    assert found == size
    assert (residual > 1e-3) == (soft == (False, False))


@pytest.mark.parametrize("soft", [(False, False), (True, True), (False, True, False)])
def test_gradient_of_V_where_every_limit_is_kept(soft: tuple[bool, ...]) -> None:
    """The same where V* is small, as it is at grasps: the first ten such members."""
    kept = 0
    for seed in range(200):
        family, x = random_family(seed, soft, 1, torque=0.0), np.zeros(3)
        if V_star(family, x) < 0.1 * LIMITS.strict_cost:
            check_gradients(family, x)
            kept += 1
            if kept == 10:
                return
    pytest.fail(f"only {kept} families keep the limits")


def test_gradient_of_the_residual_is_zero_where_it_vanishes() -> None:
    family = random_family(3, (True, True), 1)
    balanced = Load(family.load.center_of_mass, np.zeros(6), RADIUS)
    statics = grasp_statics(family.at(ORIGIN), family.models, family.hand, balanced)
    np.testing.assert_array_equal(statics.residual, 0.0)
    np.testing.assert_array_equal(residual_gradient(statics, family.derivatives(ORIGIN), family.models), 0.0)


@given(seed=SEEDS)
def test_skew_is_the_cross_product(seed: int) -> None:
    a, b = np.random.default_rng(seed).normal(size=(2, 3))
    np.testing.assert_allclose(skew(a) @ b, np.cross(a, b), atol=1e-15)
