"""Published gaits as runs: their numbers, what is proved of them, and what one of them breaks."""

import equinox as eqx
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.cli.main import main
from neuralgaits.errors import ConvergenceError, InputError
from neuralgaits.gait import BezierPolicy, ZeroDynamics
from neuralgaits.hzd.gait_file import read_gait
from neuralgaits.hzd.given_orbit import steady
from neuralgaits.records.training_config import GaitOrigin
from neuralgaits.report.page import repeat_commands
from neuralgaits.report.page.document import document
from neuralgaits.report.page.saved import Contents
from neuralgaits.training.precision import cast
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.given_run import given_run
from neuralgaits.workflows.import_gait import import_gait
from neuralgaits.workflows.inspect import inspect
from neuralgaits.workflows.report import saved_of
from support import published_gaits


@pytest.fixture(scope="module")
def imported(amber, tmp_path_factory):
    """The gait of 0.67 m/s as a run."""
    root = tmp_path_factory.mktemp("runs")
    begun: list[bool] = []
    found = import_gait(
        published_gaits.FILE,
        amber,
        name="0.67",
        out=root / "run",
        begun=lambda: begun.append(True),
        root=root,
    )
    assert begun
    return found


def test_the_orbit_is_the_published_one(imported):
    """Speed, cost of transport and multiplier as they were recomputed elsewhere, at full order."""
    found, steady = imported.summary, published_gaits.GAITS["0.67"]["recomputed"]["steady"]
    assert found.speed_m_s == pytest.approx(steady["v"], rel=1e-3)
    assert found.cost_of_transport == pytest.approx(steady["mech_cot"], rel=1e-3)
    assert found.multiplier == pytest.approx(steady["lambda_restricted"], rel=1e-3)


def test_the_run_opens_as_any_other(imported):
    opened = open_run(imported.path)
    gait = published_gaits.GAITS["0.67"]
    policy = opened.gait.policy
    assert isinstance(policy, BezierPolicy)
    np.testing.assert_array_equal(policy.coefficients, gait["bezier"])
    assert opened.summary.tied and opened.summary.left_out is None
    assert opened.summary.broken == {} and opened.config.as_given is not None
    # The run's own copy makes it again.
    line = repeat_commands.training(opened.folder)
    assert line is not None and line.startswith(f"neuralgaits import-gait {opened.path}/gait.json")


def test_its_page_speaks_of_no_training(imported):
    page = document(
        Contents(
            saved=saved_of(imported.folder),
            robot=inspect(imported.robot),
            walk=None,
            no_walk="not walked",
            figures=[],
            assumptions=(),
        )
    )
    assert "Nothing was trained: Bézier polynomials of degree 4 in z1 were read" in page
    assert "A polynomial says where every joint should be, from one number alone" in page
    assert "network says" not in page and "neuralgaits import-gait" in page


def test_outputs_stay_in_single_precision(imported):
    """As a training needs them that goes on from such a gait."""
    single = cast(imported.gait.policy, np.float32)
    z = np.array([0.05, 15.0], dtype=np.float32)
    y = single(z)
    assert y.dtype == np.float32
    np.testing.assert_allclose(y, imported.gait.policy(np.array([0.05, 15.0])), atol=1e-6)


def test_zeta_grows_alike_on_all_trajectories(imported):
    """What the tube rests on: on outputs of z1 alone dzeta/dz1 does not depend on zeta."""
    zd = imported.zero_dynamics
    for z1 in (-0.15, 0.0, 0.15):
        slopes = [z2 * (dz := zd.zdot(np.array([z1, z2])))[1] / dz[0] for z2 in (8.0, 14.0, 25.0)]
        np.testing.assert_allclose(slopes, slopes[0], rtol=1e-10)


def test_a_published_gait_is_proved_to_level_three(imported):
    found = certify(imported).summary
    assert found.verdict == "proved" and found.proved_level == 3


@pytest.mark.slow
def test_what_a_gait_breaks_is_said(amber, tmp_path):
    """The fastest needs 42.5 N m on its orbit; the robot has 41."""
    run = import_gait(published_gaits.FILE, amber, name="0.84", out=tmp_path / "run", root=tmp_path)
    found = certify(run).summary
    open_ones = [name for name, one in found.conditions.items() if one.verdict != "proved"]
    assert open_ones == ["torque-upper"]
    point = found.conditions["torque-upper"].counterexample
    assert point is not None
    assert np.max(np.asarray(run.zero_dynamics.point(np.array(point.z)).torque)) > 41.0


@pytest.mark.parametrize("value", [None, 0.0, 0.3])
@pytest.mark.parametrize(
    ("by", "error", "said"),
    [
        ("import-gait", InputError, "expected a gait with a periodic orbit on amber3m.* joints'"),
        # Its equations hold at nodes; the flow between them need not keep what they promise.
        ("optimise", ConvergenceError, "of amber3m at 0.35 m/s, found one in .* another speed"),
    ],
)
def test_a_gait_without_an_orbit_is_refused(amber, tmp_path, value, by, error, said):
    """Joints that do not move, also all at the same angle, where the dynamics are singular."""
    gait = read_gait(published_gaits.FILE, amber, "0.67")
    stiff = gait.coefficients.copy()
    stiff[:] = stiff[:, :1] if value is None else value
    given = GaitOrigin(by, gait.degree, 0.35 if by == "optimise" else None)
    with pytest.raises(error, match=said):
        still = gait._replace(coefficients=stiff)
        given_run(
            ZeroDynamics(amber, still.policy),
            still,
            given,
            start_time=0.0,
            out=tmp_path / "run",
            root=tmp_path,
        )
    assert not (tmp_path / "run").exists()


def test_gravity_scales_the_walk(imported):
    """Froude: without damping four times the gravity doubles the speed, and costs as much."""
    gravity = np.asarray(4.0 * imported.robot.gravity)
    robot = eqx.tree_at(lambda one: one.gravity, imported.robot, gravity)
    walk, found = steady(ZeroDynamics(robot, imported.gait.policy)), imported.summary
    assert not isinstance(walk, str) and np.all(np.asarray(robot.damping) == 0.0)
    assert walk.speed_m_s == pytest.approx(2.0 * found.speed_m_s, rel=1e-8)
    assert walk.cost_of_transport == pytest.approx(found.cost_of_transport, rel=1e-8)


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["import-gait", "none.json", "--robot", "amber3m"], 2, "expected a gait file, found none"),
        (["train", "amber3m", "--spec", "hzd"], 2, "neuralgaits import-gait"),
        (["optimise", "amber3m", "--speed", "-1"], 2, "expected --speed above 0 m/s, found -1"),
        (["optimise", "amber3m", "--speed", "0.7", "--degree", "2"], 2, "--degree from 3 to 20"),
    ],
)
def test_bad_input_is_one_line(words, code, said, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(words) == code
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
