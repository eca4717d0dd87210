"""Many seeds in one command: each comes to what it comes to alone, and is a run like any other."""

import errno
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import equinox as eqx
import jax
import numpy as np
import pytest

import neuralgaits as ng
from neuralgaits.analysis.run import open_run
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError, Interrupted, NonFiniteError
from neuralgaits.runs import resolve, resolve_unfinished
from neuralgaits.runs.names import STATE, SUMMARY
from neuralgaits.training import seed_batch, training_loop
from neuralgaits.training.seed_batch import SeedBatch
from neuralgaits.training.trainer import SMALLER, Trainer
from neuralgaits.workflows import seed_batches, side_by_side
from neuralgaits.workflows import train as train_workflow
from neuralgaits.workflows import train_seeds as workflow
from neuralgaits.workflows.seed_batches import batch_size
from neuralgaits.workflows.train import train
from neuralgaits.workflows.train_seeds import train_seeds
from support import small_spec

SMALL = f"{small_spec.__file__}:small"
STEPS, LOOK = 25, 10
"""Gradient steps, and how many are between two looks here: so there are three."""
SHARDED = """
import sys
from pathlib import Path

import jax

from neuralgaits.robots import load_robot
from neuralgaits.workflows.train_seeds import train_seeds

spec, out = sys.argv[1], Path(sys.argv[2])
robot = load_robot("amber3m")
done = train_seeds(robot, spec, seeds=(3, 6), steps=20, out=out, root=out.parent)
assert len(jax.devices()) == done.summary.devices == 2, jax.devices()
"""


@pytest.fixture(scope="module", autouse=True)
def often():
    """Looks at a training after fewer steps."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (seed_batch, training_loop):
            patch.setattr(module, "VALIDATE_EVERY", LOOK)
        yield


@pytest.fixture(scope="module")
def amber():
    return ng.load_robot("amber3m")


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    return tmp_path_factory.mktemp("runs")


@pytest.fixture(scope="module")
def told():
    return []


@pytest.fixture(scope="module")
def three(often, amber, root, told):
    """Seeds 3, 4 and 5, two at a time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(side_by_side, "cores", lambda: 2)
        return ng.train_seeds(
            amber,
            SMALL,
            seeds=(3, 6),
            steps=STEPS,
            out=root / "three",
            root=root,
            progress=lambda *news: told.append(news),
        )


@pytest.fixture
def together(monkeypatch):
    """Two seeds of a batch as one program, as on an accelerator."""
    monkeypatch.setattr(workflow, "as_one_program", lambda: True)
    monkeypatch.setattr(seed_batches, "AT_ONCE", 2)


def nearly(one, other, within=1e-9):
    for a, b in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        np.testing.assert_allclose(a, b, rtol=within, atol=within)


def test_gradients_and_losses_of_a_step_are_those_of_single_trainings(three):
    """From the same states, at step numbers that differ, to rounding in single precision.

    Weights are no measure of that: where a gradient is no more than rounding, Adam takes a whole
    step all the same.
    """
    trainers = [_trainer(run) for run in three.runs]
    states = []
    for number, (trainer, run) in enumerate(zip(trainers, three.runs, strict=True)):
        state, _ = trainer.step(trainer.init(run.trained), number)
        states.append(state._replace(optimizer=trainer.init(run.trained).optimizer))
    stacked = jax.tree.map(lambda *leaves: np.stack(leaves), *states)
    keys = jax.numpy.stack([jax.random.key(trainer.seed) for trainer in trainers])
    _, moments, losses = (
        trainers[0]
        .over_seeds()
        .step(stacked.parameters, stacked.optimizer, keys, stacked.step, 1, stacked.rate)
    )
    for number, (trainer, state) in enumerate(zip(trainers, states, strict=True)):
        alone, loss = trainer.step(state)
        nearly(losses.total[number], loss.total, 1e-5)
        nearly(losses.terms[number], loss.terms, 1e-5)
        for ours, its in zip(
            jax.tree.leaves(moments), jax.tree.leaves(alone.optimizer), strict=True
        ):
            np.testing.assert_allclose(
                ours[number], its, rtol=0, atol=1e-4 * np.max(np.abs(its), initial=0.0)
            )


def test_a_run_of_many_is_the_single_one_bit_for_bit(three, amber, root):
    """Beside another and after it: weights, losses on the way, what is said of them."""
    for seed in (4, 5):
        alone = train(amber, SMALL, seed=seed, steps=STEPS, out=root / f"alone-{seed}", root=root)
        run = open_run(root / "three" / str(seed))
        assert dict(run.asked) == dict(alone.asked)
        assert eqx.tree_equal(run.trained, alone.trained)
        ours, theirs = run.folder.read_metrics(), alone.folder.read_metrics()
        assert [row["step"] for row in ours] == [10, 20, STEPS]
        assert ours == theirs
        mine, its = dict(run.summary), dict(alone.summary)
        assert set(mine) == set(its)
        own = {"run", "compile_s", "train_s", "wall_s"}
        assert {name for name in mine if mine[name] != its[name]} <= own
        files = [{p.name for p in one.path.iterdir() if p.is_file()} for one in (run, alone)]
        assert files[0] == files[1]


def test_one_program_for_all_seeds_comes_near_them(three, amber, root, together):
    """As an accelerator trains them; losses as near as chaos lets them be."""
    out = root / "together"
    done = train_seeds(amber, SMALL, seeds=(3, 6), steps=STEPS, out=out, root=root)
    for ours, alone in zip(done.runs, three.runs, strict=True):
        a, b = ours.folder.read_metrics(), alone.folder.read_metrics()
        assert [row["step"] for row in a] == [row["step"] for row in b]
        for mine, its in zip(a, b, strict=True):
            assert mine["loss"] == pytest.approx(its["loss"], rel=0.02)
            assert mine["validation_loss"] == pytest.approx(its["validation_loss"], rel=0.02)
        assert ours.summary.loss == pytest.approx(alone.summary.loss, rel=0.02)


def test_what_is_said_of_them_is_in_their_folder(three, root, told):
    summary = three.summary
    assert [one.seed for one in summary.seeds] == [3, 4, 5]
    assert json.loads((root / "three" / "seeds.json").read_text()) == dict(summary)
    assert (summary.batch, summary.devices, summary.steps) == (2, 1, STEPS)
    assert [run.path.name for run in three.runs] == ["3", "4", "5"]
    steps = [step for step, *_ in told]
    assert steps == sorted(steps) and told[-1][:2] == (3 * STEPS, 3 * STEPS)
    assert all(np.isfinite(loss) for *_, loss in told)


def test_a_killed_seed_goes_on_to_the_same_weights(three, root, tmp_path):
    """From the checkpoint of the batch, by the single training, bit for bit."""
    run = three.runs[1]
    kept = run.folder.read_tree(STATE, _trainer(run).init(run.trained))
    assert int(kept.step) == STEPS
    (run.path / SUMMARY).rename(tmp_path / SUMMARY)
    again = train(resume=run.path, root=root)
    assert eqx.tree_equal(again.trained, run.trained)
    assert again.summary.loss == run.summary.loss


def _trainer(run):
    return Trainer.build(run.robot, run.spec, run.trained, steps=STEPS, seed=run.asked.seed)


def test_a_seed_is_walked_by_the_verb(three, capfd):
    code = main(["simulate", str(three.runs[0].path), "--steps", "1", "--json"])
    assert code in (0, 1), capfd.readouterr().err


def test_a_seed_that_turns_to_nan_goes_on_smaller_and_leaves_the_other(
    three, amber, root, monkeypatch
):
    """As alone: from the best weights before that, over the same steps again."""
    spoilt, step = [], Trainer.step

    def once(self, state, count=1):
        if self.seed == 4 and not spoilt and int(state.step):
            spoilt.append(state)
            state = state._replace(parameters=np.full_like(state.parameters, np.nan))
        return step(self, state, count)

    monkeypatch.setattr(Trainer, "step", once)
    out = root / "spoilt"
    done = train_seeds(amber, SMALL, seeds=(3, 5), steps=STEPS, out=out, root=root)
    first, second = done.runs
    assert spoilt and eqx.tree_equal(first.trained, three.runs[0].trained)
    assert second.summary.step_size == pytest.approx(SMALLER)
    assert first.summary.step_size == 1.0


def test_a_seed_of_a_batch_that_turns_to_nan_goes_on_smaller(amber, root, monkeypatch, together):
    """The same, as one program: the other seed is what it is without that."""
    whole = train_seeds(amber, SMALL, seeds=(3, 5), steps=STEPS, out=root / "whole-2", root=root)
    spoilt, block = [], SeedBatch._block

    def once(self, going):
        losses = block(self, going)
        if not spoilt:
            spoilt.append(self.members[1])
            one = self.members[1]
            one.state = one.state._replace(parameters=np.full_like(one.state.parameters, np.nan))
        return losses

    monkeypatch.setattr(SeedBatch, "_block", once)
    out = root / "spoilt-2"
    done = train_seeds(amber, SMALL, seeds=(3, 5), steps=STEPS, out=out, root=root)
    first, second = done.runs
    nearly(first.trained, whole.runs[0].trained)
    assert second.summary.step_size == pytest.approx(SMALLER)
    assert [row["step"] for row in second.folder.read_metrics()] == [10, 20, STEPS]
    assert first.summary.step_size == 1.0


@pytest.mark.parametrize("way", ["side by side", "one program"])
def test_a_seed_without_a_way_out_is_refused_with_its_reason(
    way, amber, root, monkeypatch, capfd, request
):
    if way == "one program":
        request.getfixturevalue("together")
    look, step, out = Trainer.restart_with_smaller_rate, Trainer.step, way.replace(" ", "-")
    monkeypatch.setattr(
        Trainer,
        "restart_with_smaller_rate",
        lambda self, kept: look(self, kept._replace(rate=np.float32(0.0))),
    )
    begun = SeedBatch._begun

    def second_is_nan(self, run):
        one = begun(self, run)
        if run.asked.seed == 1:
            bad = np.full_like(one.state.parameters, np.nan)
            one.state = one.kept = one.state._replace(parameters=bad)
        return one

    def nan_of_second(self, state, count=1):
        if self.seed == 1:
            state = state._replace(parameters=np.full_like(state.parameters, np.nan))
        return step(self, state, count)

    monkeypatch.setattr(SeedBatch, "_begun", second_is_nan)
    monkeypatch.setattr(Trainer, "step", nan_of_second)
    monkeypatch.chdir(root)
    words = ["train", "amber3m", "--spec", SMALL, "--seeds", "0:3", "--steps", "5"]
    assert main([*words, "--out", out]) == 1
    said = capfd.readouterr().out
    assert "trained: 2 of 3 seeds" in said
    assert "seed 1: expected a finite loss and weights, found NaN or infinity at step 1" in said
    assert [(root / out / str(n) / SUMMARY).is_file() for n in range(3)] == [1, 0, 1]
    rows = json.loads((root / out / "seeds.json").read_text())["seeds"]
    assert [row["refused"] is None for row in rows] == [True, False, True]
    assert (root / out / "1" / "nan.json").is_file()
    assert resolve("latest", root / "runs").path == (root / out / "2").resolve()


def test_progress_ends_at_all_steps_though_the_last_seed_is_refused(amber, tmp_path, monkeypatch):
    monkeypatch.setattr(side_by_side, "cores", lambda: 1)
    told, whole = [], side_by_side.train_to_the_end

    def refusing(run, **how):
        if run.asked.seed == 1:
            raise NonFiniteError("no way out")
        return whole(run, **how)

    monkeypatch.setattr(side_by_side, "train_to_the_end", refusing)
    found = train_seeds(
        amber,
        SMALL,
        seeds=(0, 2),
        steps=5,
        root=tmp_path,
        progress=lambda *news: told.append(news),
    )
    assert len(found.runs) == 1
    done, steps, _ = told[-1]
    assert done == steps == 5


def test_devices_share_a_batch(amber, root, together):
    """Two devices of this processor: three seeds, filled up to four."""
    out = root / "sharded"
    flags = os.environ.get("XLA_FLAGS", "") + " --xla_force_host_platform_device_count=2"
    path = str(Path(ng.__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-c", SHARDED, SMALL, str(out)],
        env=os.environ | {"XLA_FLAGS": flags, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    here = train_seeds(amber, SMALL, seeds=(3, 6), steps=20, out=root / "whole", root=root)
    for run in here.runs:
        nearly(open_run(out / run.path.name).trained, run.trained, 1e-6)


@pytest.mark.parametrize("way", ["side by side", "one program"])
def test_ctrl_c_keeps_every_seed_and_says_how_to_go_on(way, amber, tmp_path, monkeypatch, request):
    def stop(step, every, loss):
        if step >= 2 * LOOK:
            raise KeyboardInterrupt

    if way == "one program":
        request.getfixturevalue("together")
    # Two threads begin one after the other, or both before that.
    monkeypatch.setattr(side_by_side, "cores", lambda: 1)
    with pytest.raises(Interrupted) as stopped:
        train_seeds(amber, SMALL, seeds=(0, 5), steps=STEPS, root=tmp_path, progress=stop)
    folder = resolve_unfinished("latest", tmp_path)
    last = 1 if way == "one program" else 0
    assert folder.path.name == str(last) and folder.path.parents[2] == tmp_path / "seeds"
    assert stopped.value.command.endswith(f"train --resume {folder.path.with_name('0')}")
    others = f"; and so with each of {last} more" if last else ""
    assert stopped.value.more == f"{others}; seeds {last + 1} to 4 were not begun"
    assert not folder.path.with_name(str(last + 1)).exists()


def test_ctrl_c_ends_all_threads_and_what_was_begun_can_be_gone_on_with(
    amber, tmp_path, monkeypatch
):
    """However far the other one came."""

    def stop(step, every, loss):
        if step > STEPS:
            raise KeyboardInterrupt

    monkeypatch.setattr(side_by_side, "cores", lambda: 2)
    out = tmp_path / "out"
    with pytest.raises(Interrupted) as stopped:
        train_seeds(amber, SMALL, seeds=(0, 9), steps=STEPS, out=out, root=tmp_path, progress=stop)
    left = [
        n for n in range(9) if (out / str(n)).exists() and not (out / str(n) / SUMMARY).exists()
    ]
    assert left and not (out / "4").exists() and not (out / "seeds.json").exists()
    assert stopped.value.command.endswith(f"train --resume {out / str(left[0])}")
    again = train(resume=out / str(left[0]), root=tmp_path)
    alone = train(amber, SMALL, seed=left[0], steps=STEPS, out=tmp_path / "alone", root=tmp_path)
    assert eqx.tree_equal(again.trained, alone.trained)


@pytest.fixture
def stopped_after(monkeypatch):
    """Ctrl-C that comes when so many seeds have ended."""
    whole = side_by_side.SideBySide.train

    def after(count):
        def train(self, numbers, progress):
            whole(self, numbers[:count], progress)
            raise KeyboardInterrupt

        monkeypatch.setattr(side_by_side.SideBySide, "train", train)

    return after


def test_ctrl_c_behind_the_last_step_of_all_is_too_late(amber, tmp_path, stopped_after):
    stopped_after(2)
    done = train_seeds(amber, SMALL, seeds=(0, 2), steps=5, out=tmp_path / "out", root=tmp_path)
    assert [run.asked.seed for run in done.runs] == [0, 1]
    assert len(json.loads((tmp_path / "out" / "seeds.json").read_text())["seeds"]) == 2


def test_ctrl_c_between_seeds_says_what_was_refused_and_what_was_not_begun(
    amber, tmp_path, monkeypatch, stopped_after
):
    """Whoever goes on needs another folder; a seed that was refused is none to go on with."""
    look, step = Trainer.restart_with_smaller_rate, Trainer.step
    monkeypatch.setattr(
        Trainer,
        "restart_with_smaller_rate",
        lambda self, kept: look(self, kept._replace(rate=np.float32(0.0))),
    )

    def nan_of_first(self, state, count=1):
        if self.seed == 0:
            state = state._replace(parameters=np.full_like(state.parameters, np.nan))
        return step(self, state, count)

    monkeypatch.setattr(Trainer, "step", nan_of_first)
    stopped_after(2)
    with pytest.raises(Interrupted) as stopped:
        train_seeds(amber, SMALL, seeds=(0, 9), steps=5, out=tmp_path / "out", root=tmp_path)
    assert stopped.value.command.endswith("train amber3m --seeds 2:9")
    assert stopped.value.more == (
        " and the settings that were given, in another folder; refused, see nan.json: 0"
    )


def test_an_error_of_one_ends_all_and_is_raised(amber, tmp_path, monkeypatch):
    """A full disk is nobody's refusal."""
    monkeypatch.setattr(side_by_side, "cores", lambda: 2)

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(train_workflow, "finish", full)
    with pytest.raises(OSError, match=os.strerror(errno.ENOSPC)):
        train_seeds(amber, SMALL, seeds=(0, 9), steps=5, out=tmp_path / "out", root=tmp_path)
    assert not (tmp_path / "out" / "4").exists()


def test_batches_are_few_and_even():
    assert [batch_size(count, 1) for count in (1, 32, 33, 40, 64, 1000)] == [1, 32, 17, 20, 32, 32]
    assert [batch_size(count, 4) for count in (1, 6, 128, 129)] == [4, 8, 128, 68]


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["--seeds", "0-4"], "expected --seeds A:B or one seed, found '0-4'"),
        (["--seeds", "4:4"], "expected seeds A:B with A < B, found 4:4"),
        (["--seeds", "0:1000000000"], "expected at most 10000 seeds, found 1000000000"),
        (["--seeds", f"0:{2**31 + 1}"], "expected a seed from 0 to 2147483647"),
        (["--seeds", "0:4", "--seed", "3"], "expected --seed N or --seeds A:B, found both"),
        (["--seeds", "0:4", "--certify"], "expected --seeds without --certify, found both"),
        (["--seeds", "0:4", "--budget", "5"], "expected --seeds without --budget, found both"),
        (["--seeds", "0:4", "--resume", "r"], "expected --resume alone, found it with --seeds"),
        (["--seeds", "0:4", "--steps", "0"], "expected at least 1 gradient step, found 0"),
        (["--seeds", "0:4", "--out", "there"], "expected a new or empty folder for the runs"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_line(words, found, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "file").touch()
    assert main(["train", "amber3m", *words]) == 2
    said = capfd.readouterr()
    assert found in said.err and said.err.count("\n") == 1 and not said.out
    assert not (tmp_path / "runs").exists()


def test_a_gait_that_differs_in_more_than_weights_is_refused(amber, tmp_path):
    spec = small_spec.small(amber)

    def lower(key, init, hidden):
        gait = spec.new_gait(key, init, hidden)
        share = float(jax.random.uniform(key))
        return eqx.tree_at(lambda g: g.policy.lower, gait, replace_fn=lambda low: low - share)

    with pytest.raises(InputError, match=r"alone, found others in that of seed 1"):
        train_seeds(amber, replace(spec, new_gait=lower), seeds=(0, 2), steps=1, root=tmp_path)
