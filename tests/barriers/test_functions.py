"""Quantities of a point, each computed again from the full state in another way."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import functions as f
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.quantities import WITH_SETTINGS
from support.random_biped import random_biped

U = np.array([[0.05, 0.1], [0.3, 0.8], [0.5, 0.5], [0.75, 0.2], [1.0, 0.9]])
SHIN, THIGH, TORSO_COM = 0.4667, 0.4064, 0.21483
MASSES = {"shin": 0.85216, "thigh": 3.4261, "torso": 13.0}


def e(angle):
    """Direction of a link with an up-angle, (x, z)."""
    return np.stack([-np.sin(angle), np.cos(angle)], axis=-1)


def places(q):
    """Hip, swing foot and centre of mass of AMBER-3M, link by link. Each [N, 2]."""
    shin = q[:, 0]
    thigh = shin + q[:, 1]
    torso = thigh + q[:, 2]
    other_thigh = torso - q[:, 3]
    other_shin = other_thigh - q[:, 4]
    knee = SHIN * e(shin)
    hip = knee + THIGH * e(thigh)
    other_knee = hip - THIGH * e(other_thigh)
    foot = other_knee - SHIN * e(other_shin)
    parts = [
        (MASSES["shin"], knee - 0.171885 * e(shin)),
        (MASSES["thigh"], hip - 0.1494 * e(thigh)),
        (MASSES["torso"], hip + TORSO_COM * e(torso)),
        (MASSES["thigh"], hip - 0.1494 * e(other_thigh)),
        (MASSES["shin"], other_knee - 0.171885 * e(other_shin)),
    ]
    total = sum(mass for mass, _ in parts)
    com = np.sum([mass * place for mass, place in parts], axis=0) / total
    return hip, foot, com, torso


PLAIN = {
    name: getattr(f, name)
    for name in (
        "torso_angle joint_angles joint_rates torques normal_force foot_height foot_forward"
        " foot_vertical_velocity hip_height hip_forward hip_speed forward_rate transversal_inertia"
        " hip_state momentum reset_hip_sum reset_hip output_mismatch rate_mismatch state_mismatch"
        " impulse normal_impulse old_foot_lift squared_mismatch"
    ).split()
}


@pytest.fixture(scope="module")
def read(amber, gait, zd):
    """Every function at U, and the full states they belong to, [N, ...]."""

    def one(u):
        z = gait.z(u)
        p = zd.point(z)
        values = {name: function(p) for name, function in (PLAIN | WITH_SETTINGS).items()}
        x = zd.phi_inv(z)
        q, dq = x[:5], x[5:]
        impact = amber.impact(q, dq)
        eta, z_after = zd.phi(jnp.concatenate([impact.q, impact.dq]))
        x_after = zd.phi_inv(zd.reset(z))
        ddq = amber.acceleration(q, dq, p.torque)
        states = {"z": z, "q": q, "dq": dq, "ddq": ddq, "dz": p.dz, "eta": eta}
        states |= {"q+": impact.q, "dq+": impact.dq, "z+": z_after, "x+": x_after}
        return values, states

    return jax.tree.map(np.asarray, jax.jit(jax.vmap(one))(U))


def moving(place, q, dq, step=1e-5):
    """Velocity of a place by a fourth-order difference along the rates. [N, 2]."""
    one, two, back, far = (place(q + k * step * dq) for k in (1, 2, -1, -2))
    return (8.0 * (one - back) - (two - far)) / (12.0 * step)


def same(found, expected, tolerance=1e-9):
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance)


def test_geometry(read):
    """Written link by link from the numbers of the robot file."""
    v, s = read
    hip, foot, _, torso = places(s["q"])
    same(v["torso_angle"], torso)
    same(v["hip_forward"], hip[:, 0])
    same(v["hip_height"], hip[:, 1])
    same(v["at_least"], hip[:, 1] - 0.7)
    same(v["foot_forward"], foot[:, 0])
    same(v["foot_height"], foot[:, 1])
    same(v["joint_angles"], s["q"][:, 1:])
    same(v["at_most"], np.array([1.0, 2.0, 3.0, 4.0]) - s["q"][:, 1:])
    same(v["foot_on_circle"], (foot[:, 0] - 0.05) ** 2 + (foot[:, 1] + 0.65) ** 2 - 0.7**2)
    arc = 0.02 * (1.0 - (s["z"][:, 0] / 0.17) ** 2)
    same(v["parabolic_clearance"], foot[:, 1] - arc + 0.001)
    same(v["foot_above_arc"], foot[:, 1] - 0.08 * U[:, 0] * (1.0 - U[:, 0]))
    knees = s["q"][:, [1, 4]] * np.array([1.0, -1.0])
    same(v["knee_bend"], knees - 0.05)


def test_rates(read):
    """By differences of the geometry."""
    v, s = read
    same(v["joint_rates"], s["dq"][:, 1:])
    same(v["hip_speed"], moving(lambda q: places(q)[0], s["q"], s["dq"])[:, 0], 1e-8)
    foot = moving(lambda q: places(q)[1], s["q"], s["dq"])
    same(v["foot_vertical_velocity"], foot[:, 1], 1e-8)
    lift = moving(lambda q: places(q)[1], s["q+"], s["dq+"])
    same(v["old_foot_lift"], lift[:, 1], 1e-8)
    same(v["forward_rate"], s["dz"][:, 0])
    same(v["hip_state"], s["z"][:, 0])
    same(v["momentum"], s["z"][:, 1])


def test_transversal_inertia(amber, gait, zd, read):
    """-d z2 / d dz1 of a state that moves along the outputs: z2 per unit of dz1 at rest of z2."""
    v, _ = read

    def spin(u):
        z = gait.z(u)
        along = jax.jvp(lambda z: zd.point(z).q, (z,), (jnp.array([1.0, 0.0]),))[1]
        q = zd.point(z).q
        turn = amber.link_angles
        # Angular momentum about the stance foot, body by body.
        mass = amber.mass_matrix(q) - jnp.diag(amber.armature)
        return -jnp.linalg.solve(turn.T, mass @ along).sum()

    same(v["transversal_inertia"], jax.jit(jax.vmap(spin))(U), 1e-9)


def test_contact(amber, read):
    """Force from the centre of mass' acceleration, along q(t) = q + dq t + ddq t^2 / 2."""
    v, s = read
    step = 1e-3

    def com(t):
        return places(s["q"] + t * s["dq"] + 0.5 * t * t * s["ddq"])[2]

    near, far = com(step) + com(-step), com(2 * step) + com(-2 * step)
    acceleration = (16.0 * near - far - 30.0 * com(0.0)) / (12.0 * step**2)
    force = float(amber.mass) * (acceleration + np.array([0.0, 9.81]))
    same(v["normal_force"], force[:, 1], 1e-5)
    same(v["friction_forward"], 0.4 * force[:, 1] - force[:, 0], 1e-5)
    same(v["friction_backward"], 0.4 * force[:, 1] + force[:, 0], 1e-5)


def test_torques_do_the_work(amber, read):
    """Their power is the rate of the energy, by a difference along the motion."""
    v, s = read
    step = 1e-4

    def energy(t):
        q = s["q"] + t * s["dq"] + 0.5 * t * t * s["ddq"]
        dq = s["dq"] + t * s["ddq"]
        masses = np.array([amber.mass_matrix(row) for row in q])
        kinetic = 0.5 * np.einsum("ni,nij,nj->n", dq, masses, dq)
        return kinetic + float(amber.mass) * 9.81 * places(q)[2][:, 1]

    power = (energy(step) - energy(-step)) / (2.0 * step)
    same(np.sum(v["torques"] * s["dq"][:, 1:], axis=1), power, 1e-4)
    share = v["torques"] / (0.8 * 41.0)
    same(v["torque_lower"], 1.0 + share)
    same(v["torque_upper"], 1.0 - share)


def test_impact(amber, read):
    """Impulse is the change of momentum; the rest is read off the states on both sides."""
    v, s = read
    after = moving(lambda q: places(q)[2], s["q+"], s["dq+"])
    before = moving(lambda q: places(q)[2], s["q"], s["dq"])
    impulse = float(amber.mass) * (after - before)
    same(v["impulse"], impulse, 1e-7)
    same(v["normal_impulse"], impulse[:, 1], 1e-7)
    same(v["impulse_cone_forward"], 0.5 * impulse[:, 1] - impulse[:, 0], 1e-7)
    same(v["impulse_cone_backward"], 0.5 * impulse[:, 1] + impulse[:, 0], 1e-7)
    same(v["reset_hip"], s["z+"][:, 0])
    same(v["reset_hip_sum"], s["z+"][:, 0] + s["z"][:, 0])
    same(v["output_mismatch"], s["eta"][:, :4])
    same(v["squared_mismatch"], -np.sum(s["eta"][:, :4] ** 2, axis=1))
    same(v["rate_mismatch"], s["eta"][:, 4:], 1e-8)
    same(v["state_mismatch"], np.concatenate([s["q+"], s["dq+"]], axis=1) - s["x+"], 1e-8)
    same(v["after_reset"], places(s["x+"][:, :5])[3])


def test_orbital_energy(amber, read):
    v, s = read
    z1, z2 = s["z"].T
    energy = (z2 / (float(amber.mass) * 0.9)) ** 2 - 9.81 / 0.9 * z1**2
    same(v["orbital_energy"], energy - 0.3 * z1)


def test_a_biped_without_a_torso_has_no_torso_angle(gait):
    legs = robot_from_text(random_biped(7, 2, torso=False), "legs")
    point = ZeroDynamics(legs, gait.policy).point(np.array([0.0, 1.0]))
    with pytest.raises(SpecError, match="robot 'legs' has no torso; leave it out"):
        f.torso_angle(point)
