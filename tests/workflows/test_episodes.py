"""Rounds of episodes: what they write, how they go on, what they refuse.

Walks are simulated, short ones; learning and refining have tests of their own, and stand-ins here
that leave the same files. The figure is drawn where it is looked at.
"""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.analysis.run import open_run
from neuralgaits.episode_rounds import round_walks as episode_walks
from neuralgaits.episode_rounds.round_walks import Field, logs_of, nominal_momentum, walk_round
from neuralgaits.errors import InputError, NeuralGaitsError, NonFiniteError, RunError
from neuralgaits.records.episode_records import EpisodesSummary
from neuralgaits.records.fitted import FitSummary, StrideCounts
from neuralgaits.report.figures import rounds as figure
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.workflows import episodes as workflow
from neuralgaits.workflows.episodes import episodes
from support import own_columns

pytestmark = pytest.mark.slow

FIELDS = {"steps_walked", "speed_range_m_s", "heldout_error", "nominal_heldout_error", "loss"}
LEARNED = FitSummary(
    logs=("walk.csv",),
    strides=StrideCounts(train=3, heldout=1),
    walked_s=3.0,
    error_bound=(0.1, 0.2),
    heldout_error=0.1,
    nominal_heldout_error=0.4,
    binned_floor=None,
    wall_s=1.0,
)


class Stopped(BaseException):
    """A kill."""


class StandIns:
    """Walking, learning and refining that only leave files, and stop when told to."""

    def __init__(self, walked):
        self.walked = walked
        self.calls: list[tuple[str, str]] = []
        self.stop_at: tuple[str, str] | None = None
        self.columns: str | None = None

    def _called(self, what, path):
        self.calls.append((what, Path(path).name))
        if self.stop_at == self.calls[-1]:
            raise Stopped

    def walk_round(self, run, field, *, momentum, seed, folder):
        del field, momentum, seed
        self._called("walk", run.path)
        shutil.copytree(Path(self.walked["logs"][0]).parent, folder)
        return replace(self.walked, logs=tuple(str(file) for file in sorted(folder.iterdir())))

    def fit(self, run, files, *, columns, seed):
        del seed
        self.columns = columns
        self._called("fit", run.path)
        assert files and all(Path(file).is_file() for file in files)
        run.folder.write_json("residual/summary.json", LEARNED)
        return SimpleNamespace(summary=LEARNED)

    def refine(self, run, *, out, **settings):
        del settings
        self._called("refine", out)
        shutil.copytree(run.path, out, ignore=made_later)
        return open_run(out)


def made_later(folder, names):
    return [name for name in names if (Path(folder) / name).is_dir()]


ALL = [("walk", "round-0"), ("fit", "round-0"), ("refine", "round-1")]
ALL += [("walk", "round-1"), ("fit", "round-1")]


@pytest.fixture(scope="module")
def walked(amber, brief_run, tmp_path_factory):
    """A few short walks on a disturbed plant, as a round asks for them."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in {
            "STARTS": 2,
            "STEPS": 3,
            "SPEEDS": (0.9, 1.1),
            "BEYOND": (),
            "SPEED_STEPS": 3,
            "LOGGED_S": 4.0,
        }.items():
            patch.setattr(episode_walks, name, value)
        disturbance = PlantChanges(encoder_step=0.001, rate_noise=0.001)
        return walk_round(
            brief_run,
            Field(amber, disturbance, "pd"),
            momentum=nominal_momentum(brief_run),
            seed=0,
            folder=tmp_path_factory.mktemp("walked"),
        )


@pytest.fixture
def stand_ins(monkeypatch, walked):
    made = StandIns(walked)
    for name in ("walk_round", "fit", "refine"):
        monkeypatch.setattr(workflow, name, getattr(made, name))
    monkeypatch.setattr(workflow, "nominal_momentum", lambda run: 18.0)
    monkeypatch.setattr(workflow, "draw_file", lambda summary, file: file.touch())
    return made


@pytest.fixture(scope="module")
def amber():
    return load_robot("amber3m")


@pytest.fixture
def begin(amber, brief_run, tmp_path, monkeypatch):
    """Begin episodes in a folder of the test's own, named from where the command is given."""
    monkeypatch.chdir(tmp_path)

    def call(**settings):
        usual = {"plant": "amber3m-tail", "resume": brief_run.path, "out": "made"}
        return episodes(amber, **(usual | settings), root=tmp_path)

    return call


def test_a_round_walks_logs_and_judges(amber, walked, brief_run):
    assert len(walked["steps_walked"]) == 2
    assert max(walked["steps_walked"]) <= 3
    assert 0.0 < walked["barriers"]["tube"] <= 1.0
    assert 0.0 < walked["walked_s"] <= 4.0
    # Compiled, or with the reason why not.
    assert (walked["engine"], walked["engine_note"] is None) in {("native", True), ("jax", False)}
    files = [Path(file) for file in walked["logs"]]
    assert 2 <= len(files) <= 4
    read, _ = logs.read_all(files, amber)
    assert sum(log.t[-1] - log.t[0] for log in read) <= walked["walked_s"] + 1e-9
    for log, shares in zip(read[-2:], (0.9, 1.1), strict=True):
        # Walks at a speed start at z1 = 0 with that share of the momentum.
        assert log.z is not None
        np.testing.assert_allclose(log.z[0, 0], 0.0, atol=2e-3)
        momentum = shares * nominal_momentum(brief_run)
        np.testing.assert_allclose(log.z[0, 1], momentum, rtol=2e-3)
    if walked["speed_range_m_s"] is not None:
        low, high = walked["speed_range_m_s"]
        assert 0.3 < low <= high < 1.5


def test_every_round_has_an_entry_with_the_agreed_fields(stand_ins, begin, monkeypatch):
    monkeypatch.setattr(workflow, "draw_file", figure.draw_file)
    done = begin(rounds=1, disturb="torso_shift_m=-0.01,encoder_step=0.001")
    rounds = done.summary["rounds"]
    assert [entry["round"] for entry in rounds] == [0, 1]
    assert all(set(entry) >= FIELDS for entry in rounds)
    assert json.loads((done.path / "summary.json").read_text()) == done.summary
    assert stand_ins.calls == ALL
    assert done.summary["disturb"]["torso_shift_m"] == -0.01
    assert done.walks is (rounds[-1]["share_that_walks"] >= 0.9)
    assert (done.path / "episodes.png").read_bytes()[:4] == b"\x89PNG"
    assert (done.path / "round-1" / "policy.safetensors").is_file()


@pytest.mark.parametrize("stop", ALL)
def test_what_was_killed_goes_on_and_repeats_nothing(stand_ins, begin, amber, tmp_path, stop):
    stand_ins.stop_at = stop
    with pytest.raises(Stopped):
        begin(rounds=1)
    stand_ins.stop_at, stand_ins.calls = None, []
    moved = Path("made").rename("moved")
    done = episodes(amber, plant="amber3m-tail", resume=moved, root=tmp_path)
    assert stand_ins.calls == ALL[ALL.index(stop) :]
    assert [entry["round"] for entry in done.summary["rounds"]] == [0, 1]


def test_more_rounds_can_follow(stand_ins, begin, tmp_path, amber):
    first = begin(rounds=1)
    stand_ins.calls = []
    more = episodes(amber, resume=first.path, rounds=2, root=tmp_path)
    assert stand_ins.calls == [(what, "round-2") for what in ("refine", "walk", "fit")]
    assert more.summary["rounds"][:2] == first.summary["rounds"]
    assert more.run.path.name == "round-2"


def test_a_training_that_diverges_ends_the_rounds_with_the_answer_no(stand_ins, begin, monkeypatch):
    def diverge(run, **settings):
        raise NonFiniteError("loss is not finite at step 3")

    monkeypatch.setattr(workflow, "refine", diverge)
    done = begin(rounds=2)
    assert [entry["round"] for entry in done.summary["rounds"]] == [0]
    assert "step 3" in done.summary["diverged"]
    assert done.walks is False
    assert done.run.path.name == "round-0"


def test_a_robots_own_logs_serve_in_place_of_a_plant(stand_ins, begin, amber, tmp_path):
    before = begin(rounds=1)
    own = tmp_path / "own"
    shutil.copytree(before.path / "round-0" / "walks" / "logs", own)
    stand_ins.calls = []
    waiting = begin(plant=None, logs=own, rounds=1, out=tmp_path / "real")
    assert waiting.summary["waiting_for"] == str(own / "round-1")
    assert [entry["round"] for entry in waiting.summary["rounds"]] == [0]
    assert stand_ins.calls == ALL[1:3]
    assert waiting.walks is None
    own.joinpath("round-1").mkdir()
    shutil.copy(min(own.glob("*.csv")), own / "round-1")
    done = episodes(resume=waiting.path, root=tmp_path)
    assert done.summary["waiting_for"] is None
    steps = [entry["steps_walked"] for entry in done.summary["rounds"]]
    assert [len(each) for each in steps] == [len(list(own.glob("*.csv"))), 1]
    assert steps[1] == steps[0][:1]
    told, judged = (each.summary["rounds"][0]["barriers"] for each in (before, done))
    assert judged["tube"] == pytest.approx(told["tube"], abs=0.02)


def test_logs_of_own_columns_serve_too(stand_ins, begin, amber, walked, tmp_path):
    own = tmp_path / "own"
    (own / "round-0").mkdir(parents=True)
    log = logs.read(walked["logs"][0], amber).log
    file = own_columns.write(own / "round-0" / "a.csv", own_columns.values(amber, log))
    (tmp_path / "columns.toml").write_text(own_columns.SHORT)
    begun = begin(plant=None, logs=own, columns="columns.toml", rounds=1)
    assert begun.summary["waiting_for"] == str(own / "round-1")
    assert stand_ins.columns == str(tmp_path / "columns.toml")
    assert abs(begun.summary["rounds"][0]["steps_walked"][0] - count(log)) <= 1
    (own / "round-1").mkdir()
    shutil.copy(file, own / "round-1")
    done = episodes(resume=begun.path, root=tmp_path)
    assert done.summary["waiting_for"] is None
    with pytest.raises(InputError, match="expected the columns that"):
        episodes(resume=begun.path, columns="others.toml", root=tmp_path)


def count(log):
    """Touchdowns."""
    return np.count_nonzero(np.diff(log.stance))


def test_a_round_that_teaches_nothing_ends_the_command_unless_it_is_the_last(
    stand_ins, begin, monkeypatch
):
    def too_little(run, files, *, columns, seed):
        if run.path.name == "round-1":
            raise InputError("logs: expected at least 3 strides, found 2: walk longer")
        return stand_ins.fit(run, files, columns=columns, seed=seed)

    monkeypatch.setattr(workflow, "fit", too_little)
    done = begin(rounds=1)
    assert done.summary["rounds"][1]["heldout_error"] is None
    assert "at least 3 strides" in done.summary["rounds"][1]["reason"]
    with pytest.raises(InputError, match="at least 3 strides"):
        begin(rounds=2, out=done.path.parent / "longer")


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"plant": None}, "either a plant or a folder of logs, found neither"),
        ({"logs": "."}, "either a plant or a folder of logs, found both"),
        ({"plant": "amber4m"}, "unknown robot amber4m"),
        ({"plant": None, "logs": ".", "resume": None}, "the run whose policy walked the logs"),
        ({"plant": None, "logs": "nowhere"}, "found no such folder"),
        ({"plant": None, "logs": ".", "disturb": "friction=1"}, "--disturb with a plant"),
        ({"columns": "columns.toml"}, "--columns with --logs, found it with a plant"),
        ({"plant": None, "logs": "."}, "walk.csv: expected a header and rows, found an empty"),
        ({"rounds": 0}, "1 to 100 rounds, found 0"),
        ({"seed": -1}, "a seed from 0 to 2147483647, found -1"),
        ({"controller": "mpc"}, "controller: expected one of pd, fblin, found 'mpc'"),
        ({"disturb": "wind=3"}, "unknown disturbance 'wind'"),
        ({"resume": "nowhere"}, "expected a run folder at nowhere"),
        ({"resume": "latest"}, "expected episodes below"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(begin, tmp_path, settings, says):
    (tmp_path / "walk.csv").touch()
    with pytest.raises(NeuralGaitsError) as refusal:
        begin(**settings)
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert [path.name for path in tmp_path.iterdir()] == ["walk.csv"]


def test_a_folder_in_use_and_other_settings_are_refused(stand_ins, begin, amber, tmp_path):
    done = begin(rounds=1)
    with pytest.raises(RunError, match="a folder with files in it"):
        begin(rounds=1)
    others: list[tuple[dict[str, Any], str]] = [
        ({"plant": "amber3m"}, "expected the plant .* found amber3m"),
        ({"rounds": 0}, "1 to 100"),
        ({"seed": 3}, "expected the seed .* 0, found 3"),
        ({"controller": "fblin"}, "expected the controller .* pd, found fblin"),
        ({"out": tmp_path / "new"}, "--resume without --out"),
    ]
    for settings, says in others:
        with pytest.raises(InputError, match=says):
            episodes(amber, resume=done.path, **settings, root=tmp_path)
    with pytest.raises(InputError, match=r"expected the robot .* found rabbit"):
        episodes(load_robot("rabbit"), resume=done.path, root=tmp_path)


def test_speeds_held_are_the_longest_row_of_neighbours():
    shares = [0.7, 0.8, 0.9, 1.0, 1.1]
    run = episode_walks.longest_run
    assert run(shares, [True, False, True, True, False]) == (0.9, 1.0)
    assert run(shares, [True] * 5) == (0.7, 1.1)
    assert run(shares, [False] * 5) is None


def test_the_figure_draws_rounds_with_and_without_figures(tmp_path):
    entry = {
        "round": 0,
        "loss": 0.1,
        "steps_walked": [3, 4],
        "share_that_walks": 0.5,
        "speed_range_m_s": None,
        "barriers": {"rows": 0, "tube": 0.0, "all": 0.0, "conditions": {}},
        "heldout_error": None,
        "nominal_heldout_error": None,
        "binned_floor": None,
    }
    good = entry | {"round": 1, "speed_range_m_s": [0.4, 0.9], "heldout_error": 0.1}
    names = {"robot": "a", "plant": None, "logs": "own", "controller": "pd"}
    drawn = figure.draw(EpisodesSummary.of({"rounds": [entry, good], **names}))
    steps, speeds, _, errors = drawn.axes
    assert [float(y) for line in steps.lines for y in np.asarray(line.get_ydata())] == [3, 4, 3, 4]
    assert [np.asarray(line.get_ydata()).tolist() for line in speeds.lines] == [[0.4, 0.9]]
    assert len(errors.lines) == 1
    empty = EpisodesSummary.of({"rounds": [], **names})
    assert figure.draw_file(empty, tmp_path / "none.png").stat().st_size > 1000


def test_logs_of_a_round_are_csv_and_mcap(tmp_path):
    for name in ("b.csv", "a.mcap", "notes.txt"):
        (tmp_path / name).touch()
    assert [file.name for file in logs_of(tmp_path, 0)] == ["a.mcap", "b.csv"]
    with pytest.raises(InputError, match=r"expected logs \*.csv or \*.mcap in .*round-1"):
        logs_of(tmp_path, 1)
