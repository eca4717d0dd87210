"""Specs of a user's own, whose gaits and conditions hold what the built-in ones do not."""

import os
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.errors import SpecError
from neuralgaits.robots import load_robot
from neuralgaits.settings import GaitSettings
from neuralgaits.sweeps.inputs import inputs_of
from neuralgaits.workflows.new_training import new_training
from neuralgaits.workflows.train import train
from support.own_spec import replace_spec

OWN = '''
from dataclasses import replace

import equinox as eqx
import jax
import numpy as np

from neuralgaits.barriers import Gait, Pointwise, functions, specs
from neuralgaits.gait import HybridInvariantPolicy

LIMITS = np.full(4, 60.0)


class Scaled(HybridInvariantPolicy):
    """A static number that no file of weights holds, and leaves of other types."""

    factor: float = eqx.field(static=True, default=1.0)
    unused: np.ndarray = eqx.field(default_factory=lambda: np.float32(1.5) * np.ones(2, "f4"))

    def __call__(self, z):
        return self.factor * super().__call__(z)


def number(x):
    """What the key draws, if it can be read; something else if it cannot."""
    try:
        return 1.0 + 0.01 * float(x)
    except Exception:
        return 2.0


def own(robot):
    base = specs.walking(robot)
    few = [c for c in base.conditions if c.name in ("torso-upper", "normal-force")]
    power = Pointwise("power", "tube", 60.0, lambda p: LIMITS - p.torque * p.dq[1:])

    def new_gait(key, init, hidden):
        gait = base.new_gait(key, init, hidden)
        names = HybridInvariantPolicy.__dataclass_fields__
        parts = {name: getattr(gait.policy, name) for name in names}
        return Gait(Scaled(**parts, factor=number(jax.random.uniform(key))), gait.tube)

    return replace(base, conditions=(*few, power), new_gait=new_gait)
'''


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory):
    """A short training of that spec."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "mine.py").write_text(OWN)
    robot = load_robot("amber3m")
    file = f"{folder / 'mine.py'}:own"
    return train(robot, file, seed=3, steps=3, hidden=(4,), out=folder / "run", root=folder)


def test_float64_constants_train(own) -> None:
    assert own.summary["steps"] == 3
    assert np.isfinite(own.summary["loss"])
    assert "power" in own.summary["conditions"]


def test_a_gait_is_opened_as_it_was_trained(own) -> None:
    opened = open_run(Path(own.path))
    found: Any = opened.gait.policy
    assert found.factor == own.gait.policy.factor != 2.0
    z = own.gait.z(np.array([0.4, 0.5]))
    np.testing.assert_array_equal(opened.zero_dynamics.zdot(z), own.zero_dynamics.zdot(z))


def test_what_a_policy_does_not_use_may_be_of_any_type(own) -> None:
    assert own.gait.policy.unused.dtype == np.float32
    assert own.summary["provable"]


AWAY = f"import os\nos.chdir('/')\n{OWN}"


def test_a_spec_that_leaves_the_folder_leaves_paths_as_they_are(tmp_path, monkeypatch) -> None:
    """The tool returns: paths are relative to where it was called."""
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text(AWAY)
    settings = {"specs": ["mine.py:own"], "speeds": [None]}
    assert inputs_of(["amber3m"], settings)["spec-0.py"] == AWAY.encode()
    made = new_training(GaitSettings("amber3m", spec="mine.py:own", hidden=(4,)), 0)
    assert made.copies["spec.py"] == AWAY
    assert os.path.samefile(os.curdir, tmp_path)


def test_a_run_of_such_a_spec_is_opened_by_a_relative_path(own, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(own.path, "run")
    replace_spec(Path("run"), AWAY)
    assert open_run("run").config.spec == own.config.spec
    assert os.path.samefile(os.curdir, tmp_path)


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ("conditions=()", "expected at least one condition, found none"),
        ("recipe=dataclasses.replace(whole.recipe, aim=math.nan)", "recipe.aim: .*found nan"),
        ("recipe=dataclasses.replace(whole.recipe, learning_rate=0.0)", "above 0, found 0"),
    ],
)
def test_a_spec_that_cannot_be_trained_leaves_no_folder(tmp_path, changes, found):
    file = tmp_path / "mine.py"
    file.write_text(
        "import dataclasses\nimport math\nfrom neuralgaits.barriers import specs\n\n\n"
        "def mine(robot):\n    whole = specs.walking(robot)\n"
        f"    return dataclasses.replace(whole, {changes})\n"
    )
    with pytest.raises(SpecError, match=found):
        train("amber3m", f"{file}:mine", steps=1, out=tmp_path / "run")
    assert not (tmp_path / "run").exists()
