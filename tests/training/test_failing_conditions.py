"""What a training that ends in NaN says of its last finite state."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from neuralgaits.errors import NonFiniteError
from neuralgaits.training import training_loop
from neuralgaits.training.failing_conditions import failing_conditions, missed_in_words
from neuralgaits.training.train_state import FreshMargins
from neuralgaits.training.training_loop import GradientSteps

MARGINS = {
    "knees": np.array([[0.2], [-0.3]]),
    "torso-lower": np.array([[-1.0]]),
    "torque-lower": np.array([[-0.5], [-8.0]]),
    "load": np.array([[1.0]]),
    "lost": np.array([[np.nan]]),
    "reach": np.array([[-0.1]]),
}


def trainer_of(margins) -> Any:
    conditions = [SimpleNamespace(name=name, scale=2.0) for name in margins]
    nan = SimpleNamespace(total=np.nan, terms=np.full(len(margins), np.nan))
    return SimpleNamespace(
        spec=SimpleNamespace(conditions=conditions, trained_for=conditions),
        model=SimpleNamespace(torque_limit=np.array([2.0, 2.0, 1.5])),
        gait=lambda parameters: parameters,
        report=lambda gait, seed: FreshMargins(1.0, {name: margins[name] for name in margins}),
        step=lambda state: (SimpleNamespace(step=958), nan),
    )


@pytest.fixture
def steps(monkeypatch, tmp_path) -> Any:
    """Steps of a run of the default spec, whose folder keeps nothing."""
    monkeypatch.setattr(training_loop, "config_of", lambda folder: SimpleNamespace(spec="walking"))
    folder: Any = SimpleNamespace(
        path=tmp_path, write_json=lambda *_: None, write_tree=lambda *_: None
    )

    def make(margins):
        found = trainer_of(margins)
        return GradientSteps(folder, found.spec, None), found

    return make


def said_of(steps, margins) -> str:
    made, trainer = steps(margins)
    kept: Any = SimpleNamespace(step=900, parameters=None)
    with pytest.raises(NonFiniteError) as ended:
        made.refuse_nan(trainer, kept, lambda state: None)
    return str(ended.value)


def test_conditions_are_listed_worst_first():
    kept: Any = SimpleNamespace(parameters=None)
    found = failing_conditions(trainer_of(MARGINS), kept)
    assert list(found.items()) == [
        ("torque-lower", 4.0),
        ("torso-lower", 0.5),
        ("knees", 0.15),
        ("reach", 0.05),
    ]
    assert missed_in_words(found) == (
        "4 conditions fail on samples, in scales, worst first: torque-lower by 4, "
        "torso-lower by 0.5, knees by 0.15 and 1 more"
    )
    assert missed_in_words({"knees": 0.15}).startswith("1 condition fails on samples")


def test_weak_motors_are_named_where_a_built_in_spec_ends_in_nan(steps):
    """Nothing of the package's formulas is to be mended."""
    said = said_of(steps, MARGINS)
    assert (
        "found NaN or infinity at step 958, with smaller steps too; at step 900, the last" in said
    )
    assert "worst first: torque-lower by 4, torso-lower by 0.5" in said
    assert "the motors (at most 2 N m) may be too weak for this robot" in said
    assert "mend one" not in said and "\n" not in said
    assert "or train with another --seed; state of step 900 kept, reproduce with" in said


def test_strong_motors_are_not_blamed(steps):
    said = said_of(steps, {"knees": MARGINS["knees"]})
    assert "1 condition fails" in said and "too weak" not in said
    assert "knees by 0.15: train with another --seed" in said
    assert "too: train with another --seed" in said_of(steps, {"load": MARGINS["load"]})
