"""Numbers of flags that are numbers and make no sense: a line, exit 2, and nothing begun."""

import shutil

import numpy as np
import pytest
from safetensors.numpy import save_file

from neuralgaits.certificate.levels.full_order.find import ALPHAS, find_full_order
from neuralgaits.certificate.levels.full_order.samples import SampleEvaluators
from neuralgaits.certificate.levels.full_order.theorem import DECAY
from neuralgaits.cli.main import main
from neuralgaits.errors import SpecError
from neuralgaits.gait.commands import Command
from neuralgaits.runs.arrays import SHA256, read_arrays, write_arrays
from neuralgaits.runs.names import WEIGHTS
from support.shipped_run import SHIPPED

HUGE = "9" * 40
TINY = "5e-324"


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["certify", "RUN", "--level", "4", "--bandwidth", TINY], "a bandwidth of 1 to 1000 rad/s"),
        (["certify", "RUN", "--level", "4", "--bandwidth", "0.1"], "a bandwidth of 1 to 1000"),
        (["certify", "RUN", "--level", "5", "--bandwidth", "1e308"], "a bandwidth of 1 to 1000"),
        (["certify", "RUN", "--level", "4", "--bandwidth", "nan"], "a bandwidth of 1 to 1000"),
        (["certify", "RUN", "--level", "5", "--bandwidth", "nan"], "write --bandwidth 50"),
        (
            ["certify", "RUN", "--level", "4", "--clock", "free"],
            "level 5 with a free clock, found 4",
        ),
        (
            ["certify", "RUN", "--level", "4", "--controller", "scheduled-pd"],
            "level 5 with scheduled-pd, found 4",
        ),
        (["simulate", "RUN", "--steps", HUGE], "steps: expected at most 1000000, found a number"),
        (["simulate", "RUN", "--episodes", HUGE], "episodes: expected at most 1000000"),
        (["simulate", "RUN", "--push", "nan"], "expected a push of -10000 to 10000 N s"),
        (["simulate", "RUN", "--push", "nan"], "as in --push 10, or leave --push out"),
        (["simulate", "RUN", "--steps", "0"], "--steps: expected a whole number of at least 1"),
        (["simulate", "RUN", "--push", "1e308"], "expected a push of -10000 to 10000 N s"),
        (["simulate", "RUN", "--workers", HUGE], "expected at most 4096 workers"),
        (
            ["train", "amber3m", "--steps", HUGE],
            "expected at most 10000000 gradient steps",
        ),
        (["train", "amber3m", "--seed", HUGE], "found a number of 40 digits"),
        (["train", "amber3m", "--hidden", HUGE], "expected at most 8 hidden widths of at most"),
        (["train", "amber3m", "--speed", "1e308"], "expected a speed of at most 100 m/s"),
        (["train", "amber3m", "--speed", f"0:{TINY}"], "expected a range at least 1e-06 m/s wide"),
        (["train", "amber3m", "--speed", "0.5:1e308"], "between -100 and 100 m/s"),
        (["train", "amber3m", "--step-height=-1e308:0"], "between -100 and 100 m"),
        (["train", "amber3m", "--slope=0:1e9"], "between -1.5708 and 1.5708 rad"),
        (["optimise", "amber3m", "--speed", "50"], "up to 2.9 m/s, found 50"),
        (["optimise", "amber3m", "--speed", "1e308"], "expected --speed of at most 100 m/s"),
    ],
)
def test_a_number_that_makes_no_sense_is_one_line(tmp_path, monkeypatch, capfd, words, found):
    monkeypatch.chdir(tmp_path)
    run = tmp_path / "run"
    shutil.copytree(SHIPPED, run)
    assert main([str(run) if word == "RUN" else word for word in words]) == 2
    line = capfd.readouterr().err.splitlines()[-1]
    assert found in line and len(line) < 300
    assert not (tmp_path / "runs").exists()


def test_outputs_slower_than_every_barrier_are_a_reason():
    """In place of a set: the search for gains has none to try."""
    slow = 0.5 * min(ALPHAS) / float(DECAY)

    def look(u, xi):
        one = np.ones(len(u))
        return {"pace": one, "inertia": one, "foot": 1.0 - u[:, 0]}

    looks = SampleEvaluators(look, look, 2)
    assert "come back too slowly" in str(find_full_order(looks, (), slow, 1.0))


@pytest.mark.parametrize("width", [0.0, 1e-300, 1e-9])
def test_a_command_has_a_range(width):
    with pytest.raises(SpecError, match="expected a range"):
        Command("speed", 0.0, width)


@pytest.mark.parametrize("verb", ["report", "view", "simulate", "certify"])
def test_weights_that_overflow_are_refused_by_every_verb(tmp_path, capfd, verb):
    run = tmp_path / "run"
    shutil.copytree(SHIPPED, run)
    arrays, _ = read_arrays(run / WEIGHTS)
    # Files of other programs have no hash inside.
    save_file({name: np.array(1e300 * one) for name, one in arrays.items()}, run / WEIGHTS)
    assert main([verb, str(run)]) == 2
    line = capfd.readouterr().err.splitlines()[-1]
    assert line.startswith("neuralgaits: expected weights of at most 1e+30") and WEIGHTS in line


@pytest.mark.parametrize(
    ("factor", "verb", "found"),
    [
        (0.0, "report", "expected a region with room between its fences in"),
        (1e20, "export", "expected a gait whose controller goes on in its region"),
    ],
)
def test_fences_that_make_no_region_are_one_line(tmp_path, capfd, factor, verb, found):
    run = shutil.copytree(SHIPPED, tmp_path / "run")
    arrays, words = read_arrays(run / WEIGHTS)
    scaled = {
        name: np.asarray(factor * array) if name.startswith("tube.") else array
        for name, array in arrays.items()
    }
    write_arrays(run / WEIGHTS, scaled, {k: v for k, v in words.items() if k != SHA256})
    out = tmp_path / ("page.html" if verb == "report" else "c")
    assert main([verb, str(run), "--out", str(out)]) == 2
    assert found in capfd.readouterr().err.splitlines()[-1]
    assert not out.exists()
