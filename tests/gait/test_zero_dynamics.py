"""The change of coordinates, and what is refused."""

import inspect

import jax
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from support.gait_cases import CASES

ZD = {}


def maps(name):
    """Jitted phi and phi_inv of a case; its policy depends on z2."""
    if name not in ZD:
        zd = CASES[name].zd
        ZD[name] = jax.jit(lambda x: zd.phi(x)), jax.jit(lambda z, eta: zd.phi_inv(z, eta))
    return ZD[name]


def numbers(size, bound):
    return st.lists(st.floats(-bound, bound), min_size=size, max_size=size).map(np.array)


@pytest.mark.parametrize("name", ["amber3m", "legs-2"])
@given(data=st.data())
def test_phi_inverts_phi_inv(name, data):
    """On and off the zero dynamics manifold, forwards and backwards."""
    case, (phi, phi_inv) = CASES[name], maps(name)
    scale = case.policy.input_scale
    z = scale * data.draw(numbers(2, 4.0))
    eta = data.draw(numbers(2 * (case.robot.n - 1), 0.5))
    x = phi_inv(z, eta)
    back_eta, back_z = phi(x)
    size = max(1.0, float(np.max(np.abs(x))))
    np.testing.assert_allclose(back_z / scale, z / scale, rtol=0, atol=1e-10 * size)
    np.testing.assert_allclose(back_eta, eta, rtol=0, atol=1e-10 * size)


@pytest.mark.parametrize("name", ["amber3m", "legs-2"])
@given(data=st.data())
def test_phi_inv_inverts_phi(name, data):
    """From any full state whose zero dynamics are well defined."""
    case, (phi, phi_inv) = CASES[name], maps(name)
    n = case.robot.n
    x = np.concatenate([data.draw(numbers(n, 0.4)), data.draw(numbers(n, 3.0))])
    eta, z = phi(x)
    np.testing.assert_allclose(phi_inv(z, eta), x, rtol=0, atol=1e-8)


@pytest.mark.parametrize("method", ["point", "zdot", "guard", "reset", "phi_inv"])
@pytest.mark.parametrize(
    ("z", "found"),
    [
        (np.zeros(3), r"expected shape \(2,\), found \(3,\)"),
        (np.zeros((5, 2)), r"found \(5, 2\); use jax.vmap"),
        (np.array([0.1, np.nan]), "expected finite numbers"),
        ([np.inf, 20.0], "expected finite numbers"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_a_bad_state_is_refused(method, z, found):
    with pytest.raises(InputError, match=found) as refusal:
        getattr(CASES["amber3m"].zd, method)(z)
    assert "\n" not in str(refusal.value)


@pytest.mark.usefixtures("unchecked")
def test_a_bad_full_state_is_refused():
    zd = CASES["amber3m"].zd
    with pytest.raises(InputError, match=r"x: expected shape \(10,\), found \(5,\)"):
        zd.phi(np.zeros(5))
    with pytest.raises(InputError, match="x: expected finite"):
        zd.phi(np.full(10, np.nan))
    with pytest.raises(InputError, match=r"eta: expected shape \(8,\)"):
        zd.phi_inv(np.array([0.0, 20.0]), np.zeros(4))
    with pytest.raises(InputError, match="eta: expected finite"):
        zd.phi_inv(np.array([0.0, 20.0]), np.full(8, np.nan))


@pytest.mark.parametrize("z0", [np.array([0.0, np.nan]), np.zeros(3), np.zeros((1, 2))])
def test_a_bad_guess_of_the_orbit_is_refused(z0):
    with pytest.raises(InputError, match="z0: expected two finite numbers"):
        inspect.unwrap(poincare)(CASES["amber3m"].zd, z0)


@pytest.mark.parametrize("use", [ZeroDynamics.zdot, ZeroDynamics.guard, ZeroDynamics.phi_inv])
def test_a_policy_for_other_joints_is_refused(use):
    zd = ZeroDynamics(CASES["amber3m"].robot, CASES["legs-2"].policy)
    with pytest.raises(InputError, match=r"policy: expected 4 outputs, .* found shape \(3,\)"):
        use(zd, np.array([0.0, 20.0]))
    with pytest.raises(InputError, match="use a policy made for this robot"):
        zd.phi(np.zeros(10))
