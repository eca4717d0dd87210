"""The verbs that learn take a robot's own columns, and say what they computed."""

import shutil

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.analysis.run import open_run
from neuralgaits.cli.main import BAD_INPUT, main
from neuralgaits.residual.fit import FitConfig
from neuralgaits.robots import load_robot
from neuralgaits.workflows.fit import fit
from neuralgaits.workflows.simulate import simulate
from support import log_example, own_columns
from support.shipped_run import SHIPPED


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with the shipped run, a log of its walk, and the same in a robot's own columns."""
    folder = tmp_path_factory.mktemp("own")
    run = shutil.copytree(SHIPPED, folder / "run")
    simulate(run, steps=5, log=folder / "si.csv")
    robot = load_robot("amber3m")
    log = logs.read(folder / "si.csv", robot).log
    own_columns.write(folder / "own.csv", own_columns.values(robot, log))
    return folder


@pytest.mark.slow
def test_fit_learns_from_the_same_windows(place):
    """Nothing is trained: what it is given is the point."""
    config = FitConfig(patience=0)
    true = fit(place / "run", [place / "si.csv"], config=config).summary
    own = fit(
        place / "run", [place / "own.csv"], columns=log_example.COLUMNS, config=config
    ).summary
    assert own.columns == str(log_example.COLUMNS)
    assert true.columns is None and true.computed == ()
    assert "desired outputs and rates from the run's policy at that z" in own.computed
    assert own.strides == true.strides and own.windows == true.windows
    assert own.nominal_heldout_error == pytest.approx(true.nominal_heldout_error, rel=0.2)


def test_a_log_of_columns_that_nobody_knows_names_the_page(place, capsys):
    assert main(["fit", str(place / "run"), str(place / "own.csv")]) == BAD_INPUT
    said = capsys.readouterr().err.strip()
    assert "\n" not in said
    assert "found 't_ms,hip_l,knee_l,hip_r,knee_r,imu_pitch," in said
    assert "without t[s], stance[-], q_stance_shin[rad], q_stance_knee[rad], " in said
    assert "say with --columns FILE what the columns are, or add these; docs/logs.md" in said


def test_a_file_of_columns_with_a_mistake_is_one_line(place, tmp_path, capsys):
    (tmp_path / "columns.toml").write_text(own_columns.SHORT.replace('"ms"', '"min"'))
    words = ["fit", str(place / "run"), str(place / "own.csv")]
    assert main([*words, "--columns", str(tmp_path / "columns.toml")]) == BAD_INPUT
    said = capsys.readouterr().err.strip()
    assert "\n" not in said
    assert "time: expected the unit of a time (s, ms, us, ns), found 'min'" in said


def test_columns_go_with_logs(capsys):
    words = ["episodes", "amber3m", "--plant", "amber3m-tail", "--columns", "columns.toml"]
    assert main(words) == BAD_INPUT
    assert "expected --columns with --logs" in capsys.readouterr().err


def test_a_round_of_logs_is_judged(place):
    from neuralgaits.rounds.walks import logged_round

    run = open_run(place / "run")
    true = logged_round(run, [place / "si.csv"])
    own = logged_round(run, [place / "own.csv"], log_example.COLUMNS)
    # Here the simulation ends in the row of a touchdown, for which a contact takes two.
    assert own.steps_walked[0] == true.steps_walked[0] - 1
    assert set(true.barriers.conditions) > set(own.barriers.conditions)
    assert not {"torque-upper", "torque-lower"} & set(own.barriers.conditions)
    for name, share in own.barriers.conditions.items():
        np.testing.assert_allclose(share, true.barriers.conditions[name], atol=0.02)
