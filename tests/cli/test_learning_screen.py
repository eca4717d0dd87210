"""What `fit` shows a person, and how it refuses."""

import pytest

from neuralgaits.cli.brief import brief_fit
from neuralgaits.cli.learning_screen import show_fit
from neuralgaits.cli.main import main
from neuralgaits.records.fitted import FitSummary

SIZES = {"z1_m": 0.004, "z2_kg_m2_s": 0.5, "output_rad": 0.007, "rate_rad_s": 0.6}
RESULT = {
    "logs": ["walk.csv"],
    "run": "runs/one",
    "residual": "runs/one/residual/residual.safetensors",
    "train_error": 0.004,
    "nominal_train_error": 0.05,
    "heldout_error": 0.005,
    "nominal_heldout_error": 0.04,
    "binned_floor": 0.0066,
    "touchdowns": {"count": 6, "before": SIZES, "after": SIZES | {"z2_kg_m2_s": 0.031}},
    "error_bound": [0.012, 0.22],
    "bound": [0.03, 8.5],
    "strides": {"train": 25, "validation": 6, "heldout": 6},
    "left_out": {"missing": 0, "outliers": 3, "settling": 740},
    "walked_s": 31.25,
    "wall_s": 17.2,
}


def words(capsys, result):
    show_fit(FitSummary.of(result))
    return " ".join(capsys.readouterr().out.split())


def test_a_fit_shows_its_errors_and_what_it_left_out(capsys):
    text = words(capsys, RESULT)
    # 0.005 of 0.04.
    assert text.startswith("learned: 12.5 % of the model's error is left on held-out strides")
    assert "held out 0.04 0.005 0.0066" in text
    assert "momentum z2 0.5 kg m²/s 0.031 kg m²/s" in text
    assert "0.012 0.22" in text
    assert "3 outliers, 740 settling" in text
    assert "missing" not in text
    brief_fit(FitSummary.of(RESULT))
    assert "neuralgaits refine runs/one" in capsys.readouterr().out


def test_nothing_learned_is_said(capsys):
    worse = RESULT | {"heldout_error": 0.05}
    worse["touchdowns"] = {"count": 0, "before": None, "after": None}
    text = words(capsys, worse)
    assert text.startswith("not learned: 125 % of the model's error is left")
    assert "touchdowns" not in text


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        (["fit"], "RUN"),
        (["fit", "nowhere", "walk.csv"], "expected a run folder at nowhere"),
        (["fit", "nowhere", "walk.csv", "--optimizer", "sgd"], "'sgd'"),
        (["refine", "nowhere"], "expected a run folder at nowhere"),
        (["refine", "nowhere", "--disturbance", "1"], "A,B"),
        (["certify", "nowhere", "--disturbance", "learned"], "expected a run folder at nowhere"),
    ],
)
def test_bad_usage_is_one_line_and_2(capfd, arguments, found):
    assert main(arguments) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert found in err
