"""Many seeds in one command: each comes to what it comes to alone, and is a run like any other."""

import errno
import json
import os
from dataclasses import replace

import equinox as eqx
import jax
import numpy as np
import pytest

import neuralgaits as ng
from neuralgaits.analysis.run import open_run
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError, Interrupted, NonFiniteError
from neuralgaits.runs import resolve, resolve_unfinished
from neuralgaits.runs.names import STATE, TRAINING_SUMMARY
from neuralgaits.training import training_loop
from neuralgaits.training.trainer import SMALLER, Trainer
from neuralgaits.workflows import seeds_in_parallel
from neuralgaits.workflows import train as train_workflow
from neuralgaits.workflows.train import train
from neuralgaits.workflows.train_seeds import train_seeds
from support import small_spec

SMALL = f"{small_spec.__file__}:small"
STEPS, LOOK = 25, 10
"""Gradient steps, and how many are between two looks here: so there are three."""


@pytest.fixture(scope="module", autouse=True)
def often():
    """Looks at a training after fewer steps."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(training_loop, "VALIDATE_EVERY", LOOK)
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
        patch.setattr(seeds_in_parallel, "cores", lambda: 2)
        return ng.train_seeds(
            amber,
            SMALL,
            seeds=(3, 6),
            steps=STEPS,
            out=root / "three",
            root=root,
            progress=lambda *news: told.append(news),
        )


def test_a_run_of_many_is_the_single_one_bit_for_bit(three, amber, root):
    """Beside another and after it: weights, losses on the way, what is said of them."""
    for seed in (4, 5):
        alone = train(amber, SMALL, seed=seed, steps=STEPS, out=root / f"alone-{seed}", root=root)
        run = open_run(root / "three" / str(seed))
        assert dict(run.config) == dict(alone.config)
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
    """From its checkpoint, by the single training, bit for bit."""
    run = three.runs[1]
    kept = run.folder.read_tree(STATE, _trainer(run).init(run.trained))
    assert int(kept.step) == STEPS
    (run.path / TRAINING_SUMMARY).rename(tmp_path / TRAINING_SUMMARY)
    again = train(resume=run.path, root=root)
    assert eqx.tree_equal(again.trained, run.trained)
    assert again.summary.loss == run.summary.loss


def _trainer(run):
    return Trainer.build(run.robot, run.spec, run.trained, steps=STEPS, seed=run.config.seed)


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


def test_a_seed_without_a_way_out_is_refused_with_its_reason(amber, root, monkeypatch, capfd):
    look, step, out = Trainer.restart_with_smaller_rate, Trainer.step, "refused"
    monkeypatch.setattr(
        Trainer,
        "restart_with_smaller_rate",
        lambda self, kept: look(self, kept._replace(rate=np.float32(0.0))),
    )

    def nan_of_second(self, state, count=1):
        if self.seed == 1:
            state = state._replace(parameters=np.full_like(state.parameters, np.nan))
        return step(self, state, count)

    monkeypatch.setattr(Trainer, "step", nan_of_second)
    monkeypatch.chdir(root)
    words = ["train", "amber3m", "--spec", SMALL, "--seeds", "0:3", "--steps", "5"]
    assert main([*words, "--out", out]) == 1
    said = capfd.readouterr().out
    assert "trained: 2 of 3 seeds" in said
    assert "seed 1: expected a finite loss and weights, found NaN or infinity at step 1" in said
    assert [(root / out / str(n) / TRAINING_SUMMARY).is_file() for n in range(3)] == [1, 0, 1]
    rows = json.loads((root / out / "seeds.json").read_text())["seeds"]
    assert [row["refused"] is None for row in rows] == [True, False, True]
    assert (root / out / "1" / "nan.json").is_file()
    assert resolve("latest", root / "runs").path == (root / out / "2").resolve()


def test_progress_ends_at_all_steps_though_the_last_seed_is_refused(amber, tmp_path, monkeypatch):
    monkeypatch.setattr(seeds_in_parallel, "cores", lambda: 1)
    told, whole = [], seeds_in_parallel.train_to_the_end

    def refusing(run, **how):
        if run.config.seed == 1:
            raise NonFiniteError("no way out")
        return whole(run, **how)

    monkeypatch.setattr(seeds_in_parallel, "train_to_the_end", refusing)
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


def test_ctrl_c_keeps_every_seed_and_says_how_to_go_on(amber, tmp_path, monkeypatch):
    def stop(step, every, loss):
        if step >= 2 * LOOK:
            raise KeyboardInterrupt

    # Two threads begin one after the other, or both before that.
    monkeypatch.setattr(seeds_in_parallel, "cores", lambda: 1)
    with pytest.raises(Interrupted) as stopped:
        train_seeds(amber, SMALL, seeds=(0, 5), steps=STEPS, root=tmp_path, progress=stop)
    folder = resolve_unfinished("latest", tmp_path)
    assert folder.path.name == "0" and folder.path.parents[2] == tmp_path / "seeds"
    assert stopped.value.command.endswith(f"train --resume {folder.path}")
    assert stopped.value.more == "; seeds 1 to 4 were not begun"
    assert not folder.path.with_name("1").exists()


def test_ctrl_c_ends_all_threads_and_what_was_begun_can_be_gone_on_with(
    amber, tmp_path, monkeypatch
):
    """However far the other one came."""

    def stop(step, every, loss):
        if step > STEPS:
            raise KeyboardInterrupt

    monkeypatch.setattr(seeds_in_parallel, "cores", lambda: 2)
    out = tmp_path / "out"
    with pytest.raises(Interrupted) as stopped:
        train_seeds(amber, SMALL, seeds=(0, 9), steps=STEPS, out=out, root=tmp_path, progress=stop)
    left = [
        n
        for n in range(9)
        if (out / str(n)).exists() and not (out / str(n) / TRAINING_SUMMARY).exists()
    ]
    assert left and not (out / "4").exists() and not (out / "seeds.json").exists()
    assert stopped.value.command.endswith(f"train --resume {out / str(left[0])}")
    again = train(resume=out / str(left[0]), root=tmp_path)
    alone = train(amber, SMALL, seed=left[0], steps=STEPS, out=tmp_path / "alone", root=tmp_path)
    assert eqx.tree_equal(again.trained, alone.trained)


@pytest.fixture
def stopped_after(monkeypatch):
    """Ctrl-C that comes when so many seeds have ended."""
    whole = seeds_in_parallel.SeedsInParallel.train

    def after(count):
        def train(self, numbers, *others):
            whole(self, numbers[:count], *others)
            raise KeyboardInterrupt

        monkeypatch.setattr(seeds_in_parallel.SeedsInParallel, "train", train)

    return after


def test_ctrl_c_behind_the_last_step_of_all_is_too_late(amber, tmp_path, stopped_after):
    stopped_after(2)
    done = train_seeds(amber, SMALL, seeds=(0, 2), steps=5, out=tmp_path / "out", root=tmp_path)
    assert [run.config.seed for run in done.runs] == [0, 1]
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
    monkeypatch.setattr(seeds_in_parallel, "cores", lambda: 2)

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(train_workflow, "finish", full)
    with pytest.raises(OSError, match=os.strerror(errno.ENOSPC)):
        train_seeds(amber, SMALL, seeds=(0, 9), steps=5, out=tmp_path / "out", root=tmp_path)
    assert not (tmp_path / "out" / "4").exists()


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["--seeds", "0-4"], "expected --seeds A:B or one seed, found '0-4'"),
        (["--seeds", "4:4"], "expected seeds A:B with A < B, found 4:4"),
        (["--seeds", "0:1000000000"], "expected at most 10000 seeds, found 1000000000"),
        (["--seeds", f"0:{2**31 + 1}"], "expected a seed from 0 to 2147483647"),
        (["--seeds", "0:4", "--seed", "3"], "expected --seed N or --seeds A:B, found both"),
        (["--seeds", "0:4", "--certify"], "expected --seeds without --certify, found both"),
        (["--seeds", "0:4", "--budget", "5"], "expected a budget with --certify only"),
        (["--seeds", "0:4", "--resume", "r"], "expected --resume alone, found it with --seeds"),
        (
            ["--seeds", "0:4", "--steps", "0"],
            "--steps: expected a whole number of at least 1",
        ),
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
