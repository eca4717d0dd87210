"""What is drawn is what the mathematics says: the same quantities by other roads."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from neuralgaits.analysis import gait_data as workflow
from neuralgaits.analysis.gait_data import FILE, fingerprint, gait_data
from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.analysis.point_evaluator import PlaneChart, PointEvaluator
from neuralgaits.runs import read_arrays, write_arrays


@pytest.fixture(scope="module")
def known(run):
    """States to what the package's own functions say of them, compiled once."""
    zd, torso = run.zero_dynamics, run.robot.torso

    def one(z):
        return {
            "dz": zd.zdot(z),
            "guard": zd.guard(z),
            "reset": zd.reset(z),
            "torso": zd.point(z).theta[torso],
        }

    compiled = jax.jit(jax.vmap(one))

    def known(z):
        # One size is compiled: rows are filled up.
        z = np.asarray(z).reshape(-1, 2)
        filled = np.concatenate([z, np.repeat(z[-1:], 128 - len(z), axis=0)])
        return {name: np.asarray(array)[: len(z)] for name, array in compiled(filled).items()}

    return known


def test_the_flow_is_the_zero_dynamics(data, known):
    states = np.stack(np.meshgrid(data["plane/z1"][::15], data["plane/z2"][::10]), axis=-1)
    expected = known(states)["dz"]
    found = data["plane/dz"][::10, ::15].reshape(-1, 2)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


def test_the_guard_is_on_the_ground_and_the_reset_is_the_impact(data, known):
    before = data["guard/z"][::8]
    np.testing.assert_allclose(known(before)["guard"], 0.0, atol=1e-9)
    expected = known(before)["reset"]
    np.testing.assert_allclose(data["guard/z_after"][::8], expected, rtol=1e-10)


def test_the_fixed_point_is_that_of_the_poincare_map(run, data):
    numbers = data.numbers
    orbit = poincare(run.zero_dynamics, np.array([0.0, 0.9 * numbers.z2]))
    assert orbit.result == "found"
    assert numbers.z2 == pytest.approx(float(orbit.fixed_point[1]), rel=1e-9)
    assert numbers.multiplier == pytest.approx(orbit.multiplier, abs=1e-7)
    assert numbers.period_s == pytest.approx(orbit.period_s, rel=1e-9)
    assert numbers.step_length_m == pytest.approx(orbit.step_length_m, rel=1e-9)
    np.testing.assert_allclose(data["orbit/z"][-1], orbit.guard_state, rtol=1e-9)


def test_the_sampled_map_is_the_zero_dynamics_integrated_over_time(data, known):
    """By another solver, in time: to the guard, through the reset, to z1 = 0."""

    def flow(z, event):
        event.terminal = True
        settings = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-11, "events": event}
        return solve_ivp(lambda t, z: known(z)["dz"][0], (0.0, 2.0), z, **settings).y[:, -1]

    for row in (0, 17):
        before = flow([0.0, data["map/z2"][row]], lambda t, z: known(z)["guard"][0] + (z[0] <= 0.0))
        after = flow(known(before)["reset"][0], lambda t, z: z[0])
        assert data["map/z2_after"][row] == pytest.approx(after[1], rel=1e-8)


def test_the_orbit_closes_and_follows_the_flow(data, known):
    z, t = data["orbit/z"], data["orbit/t"]
    np.testing.assert_allclose(known(z[-1:])["reset"][0], z[0], rtol=1e-7)
    rates = known(z)["dz"]
    # The trapezoidal rule: what it leaves is the tolerance.
    step = np.diff(t)[:, None]
    moved = 0.5 * step * (rates[1:] + rates[:-1])
    np.testing.assert_allclose(z[1:] - z[:-1], moved, rtol=2e-3, atol=2e-4)
    assert t[-1] == pytest.approx(data.numbers.period_s, rel=1e-9)


def test_margins_are_those_of_the_conditions_where_they_apply(run, data):
    rng = np.random.default_rng(0)
    spec, gait = run.spec, run.gait
    rows = rng.integers(0, len(data["chart/level"]), 5)
    columns = rng.integers(0, len(data["chart/phase"]), 5)
    corners = [(0, 0), (0, len(data["chart/phase"]) - 1), (len(data["chart/level"]) - 1, 40)]
    margins = jax.jit(lambda u: spec.margins(gait, run.zero_dynamics, u))
    for row, column in [*zip(rows, columns, strict=True), *corners]:
        u = np.array([data["chart/phase"][column], data["chart/level"][row]])
        expected = margins(u)
        for number, condition in enumerate(spec.conditions):
            applies = any(
                np.all(u >= np.array(box.low)) and np.all(u <= np.array(box.high))
                for box in spec.regions[condition.region]
            )
            found = data["chart/margins"][number, row, column]
            least = float(np.min(expected[condition.name])) / condition.scale
            assert np.isfinite(found) == applies, condition.name
            assert not applies or found == pytest.approx(least, rel=1e-7, abs=1e-9)


def test_barriers_are_torso_angle_against_its_bounds(data, known):
    z = data["orbit/z"][::20]
    torso = known(z)["torso"]
    expected = np.stack([torso + 0.25, 0.08 - torso])
    np.testing.assert_allclose(data["orbit/barriers"][:, ::20], expected, atol=1e-10)
    assert data.barriers == ("torso-lower", "torso-upper")


def test_torques_of_the_orbit_move_the_robot_along_it(run, data):
    """Forward dynamics under the drawn torques gives the drawn motion's acceleration."""
    robot, t = run.robot, data["orbit/t"]
    middle = slice(5, -5, 7)
    given = (data["orbit/q"], data["orbit/dq"], data["orbit/torque"])
    accelerations = jax.jit(jax.vmap(robot.acceleration))(*(array[middle] for array in given))
    expected = np.stack([np.gradient(rate, t, edge_order=2) for rate in data["orbit/dq"].T], axis=1)
    np.testing.assert_allclose(accelerations, expected[middle], rtol=0.02, atol=0.05)


def test_ground_force_is_the_change_of_momentum_plus_weight(run, data):
    """Newton's law for the whole robot, with the acceleration that the torques give."""
    robot = run.robot
    up = np.array([0.0, float(robot.mass * robot.gravity)])

    def force(q, dq, torque):
        ddq = robot.acceleration(q, dq, torque)

        def velocity(q, dq):
            return jax.jvp(robot.centre_of_mass, (q,), (dq,))[1]

        return robot.mass * jax.jvp(velocity, (q, dq), (dq, ddq))[1] + up

    rows = slice(0, None, 12)
    found = jax.jit(jax.vmap(force))(
        *(data[f"orbit/{name}"][rows] for name in ("q", "dq", "torque"))
    )
    np.testing.assert_allclose(data["orbit/force"][rows], found, rtol=1e-8, atol=1e-6)


def test_the_skeleton_stands_hangs_and_swings(run, data):
    points, q = data["orbit/skeleton"][::20], data["orbit/q"][::20]
    foot = jax.jit(jax.vmap(run.robot.swing_foot))(q)
    np.testing.assert_allclose(points[:, -1], foot, atol=1e-12)
    np.testing.assert_allclose(points[:, 0], 0.0)
    links = np.linalg.norm(np.diff(points, axis=1), axis=-1)
    lengths = np.abs(np.asarray(run.robot.foot))
    torso = run.robot.torso
    expected = [*lengths[:torso], links[0, torso], links[0, torso], *lengths[torso + 1 :]]
    np.testing.assert_allclose(links, np.broadcast_to(expected, links.shape), atol=1e-12)


def test_walks_go_from_guard_to_reset(data, known):
    z = data["walks/z"]
    ends = np.flatnonzero(np.isnan(z[:, 0]))
    inside = ends[:-1][np.diff(ends) > 1]
    last, first = z[inside - 1], z[inside + 1]
    resets = known(last)["reset"]
    # The second walk begins where the first ends: that gap is no reset.
    same = np.abs(resets[:, 1] - first[:, 1]) < 1e-6
    assert same.sum() == len(same) - 1


def test_data_are_kept_and_computed_again_when_the_gait_changes(run, data, monkeypatch):
    path = run.path / FILE
    kept, words = read_arrays(path)
    assert words["of"] == fingerprint(run)
    computed = []

    def compute(run):
        computed.append(run)
        return kept

    monkeypatch.setattr(workflow, "compute", compute)
    np.testing.assert_array_equal(gait_data(run)["orbit/t"], data["orbit/t"])
    assert not computed, "what lies there is read"
    write_arrays(path, kept, {"of": "another gait"})
    gait_data(run)
    assert len(computed) == 1
    path.write_bytes(b"no safetensors")
    gait_data(run)
    assert len(computed) == 2
    gait_data(run)
    assert len(computed) == 2


def test_what_cannot_be_traced_is_compiled():
    look = PointEvaluator(lambda z: {"part": jnp.maximum(z, 0.0), "sum": z[0] + z[1]})
    z = np.array([[1.0, -2.0], [-3.0, 4.0]])
    np.testing.assert_array_equal(look(z)["part"], np.maximum(z, 0.0))
    assert list(look.only("sum")(z)) == ["sum"]
    np.testing.assert_array_equal(look.only("sum")(z)["sum"], z.sum(axis=1))


def test_the_chart_is_the_gaits(run):
    chart = PlaneChart(run.gait, run.spec)
    u = np.random.default_rng(1).uniform(size=(20, 2))
    z = chart.z(u[:, 0], u[:, 1])
    np.testing.assert_allclose(z, jax.jit(jax.vmap(run.gait.z))(u), rtol=1e-12)
    np.testing.assert_allclose(np.stack(chart.chart(z), axis=1), u, atol=1e-9)
