"""The verbs that learn take a robot's own columns, and say what they computed."""

import shutil

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.cli.main import BAD_INPUT, main
from neuralgaits.errors import InputError
from neuralgaits.residual.fitter import FitConfig
from neuralgaits.workflows.episodes import episodes
from neuralgaits.workflows.fit import fit
from support import log_example, own_columns


@pytest.mark.slow
def test_fit_learns_from_the_same_windows(shipped_walk, tmp_path):
    """Nothing is trained: what it is given is the point."""
    place, run = shipped_walk, shutil.copytree(shipped_walk / "run", tmp_path / "run")
    config = FitConfig(patience=0)
    true = fit(run, [place / "si.csv"], config=config).summary
    own = fit(run, [place / "own.csv"], columns=log_example.COLUMNS, config=config).summary
    assert own.columns == str(log_example.COLUMNS)
    assert true.columns is None and true.computed == ()
    assert "desired outputs and rates from the run's policy at that z" in own.computed
    assert own.strides == true.strides and own.windows == true.windows
    assert own.nominal_heldout_error == pytest.approx(true.nominal_heldout_error, rel=0.2)


def test_a_log_of_columns_that_nobody_knows_names_the_page(shipped_walk, capsys):
    assert main(["fit", str(shipped_walk / "run"), str(shipped_walk / "own.csv")]) == BAD_INPUT
    said = capsys.readouterr().err.strip()
    assert "\n" not in said
    assert "found 't_ms,hip_l,knee_l,hip_r,knee_r,imu_pitch," in said
    assert "without t[s], stance[-], q_stance_shin[rad], q_stance_knee[rad], " in said
    assert (
        "say with --columns FILE what the columns are, or add these; the page 'Your own logs'"
        in said
    )


def test_a_file_of_columns_with_a_mistake_is_one_line(shipped_walk, tmp_path, capsys):
    (tmp_path / "columns.toml").write_text(own_columns.SHORT.replace('"ms"', '"min"'))
    words = ["fit", str(shipped_walk / "run"), str(shipped_walk / "own.csv")]
    assert main([*words, "--columns", str(tmp_path / "columns.toml")]) == BAD_INPUT
    said = capsys.readouterr().err.strip()
    assert "\n" not in said
    assert "time: expected the unit of a time (s, ms, us, ns), found 'min'" in said


def test_columns_go_with_logs(amber, tmp_path):
    with pytest.raises(InputError, match="expected --columns with --logs"):
        episodes(amber, plant=amber, columns="columns.toml", root=tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_round_of_logs_is_judged(shipped_walk):
    from neuralgaits.episode_rounds.round_walks import logged_round

    run = open_run(shipped_walk / "run")
    true = logged_round(run, [shipped_walk / "si.csv"])
    own = logged_round(run, [shipped_walk / "own.csv"], log_example.COLUMNS)
    # Here the simulation ends in the row of a touchdown, for which a contact takes two.
    assert own.steps_walked[0] == true.steps_walked[0] - 1
    assert set(true.barriers.conditions) > set(own.barriers.conditions)
    assert not {"torque-upper", "torque-lower"} & set(own.barriers.conditions)
    for name, share in own.barriers.conditions.items():
        np.testing.assert_allclose(share, true.barriers.conditions[name], atol=0.02)
