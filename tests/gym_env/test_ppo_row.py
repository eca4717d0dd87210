"""The row that `benchmarks/peers.py` makes of what `examples/ppo.py` writes."""

import importlib.util
import json
from dataclasses import asdict
from pathlib import Path

import pytest

pytest.importorskip("gymnasium", reason="needs the gym extra: gymnasium")

from neuralgaits.gym_env import Trials

FILE = Path(__file__).parents[2] / "benchmarks" / "ppo_row.py"
STEPS, WHOLE = 25, 50


@pytest.fixture(scope="module")
def made():
    spec = importlib.util.spec_from_file_location("ppo_row", FILE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def of(*walked: int, speed: float = 0.7) -> dict:
    """Trials, as they stand in a file."""
    whole = max(walked) >= WHOLE
    found = Trials(
        steps=WHOLE,
        walked=walked,
        up_s=(1.0,) * len(walked),
        endings=tuple(None if n >= WHOLE else "hip too low" for n in walked),
        speed_m_s=speed if whole else None,
        cost_of_transport=0.2 if whole else None,
    )
    return json.loads(json.dumps(asdict(found)))


def seed_of(first: int | None, free: dict, disturbed: dict, speeds: dict) -> dict:
    """What one seed wrote: a curve with its first whole walk at `first` samples."""
    curve: list[dict] = [{"samples": 1000, "processor_s": 2.0, "episode_decisions": None}]
    for samples in (2000, 3000, 4000):
        walked = [WHOLE] if first is not None and samples >= first else [3]
        curve.append({"samples": samples, "processor_s": samples / 500, "walked": walked})
    written = {"seed": 0, "curve": curve, "disturbed": disturbed, "speeds": {"0.7": free} | speeds}
    return json.loads(json.dumps(written))


def test_seeds_become_one_row(made):
    walks = seed_of(
        2000,
        of(50, 50, speed=0.6),
        {"mass": of(50, 24), "slope": of(25, 0)},
        {"0.9": of(50, 50, speed=0.8), "0.5": of(50, 30, speed=0.4)},
    )
    falls = seed_of(None, of(3, 30), {"mass": of(3, 3), "slope": of(50, 50)}, {})
    row = made.row([walks, falls], asked=0.7, steps=STEPS)
    assert (row["learn_s"], row["speed"], row["cost"]) == (4.0, 0.6, 0.2)
    assert (row["fell"], row["walks"], row["undisturbed"]) == (4, 8, "1 of 4")
    assert row["under"] == "mass 3 of 4, slope 1 of 4"
    assert row["range"] == "speed 0.7, 0.9: 0.60 to 0.80 m/s walked; none"
    assert row["samples"].startswith("0.00 M") and "1 of 2 seeds" in row["note"]


def test_between_seeds_that_walk_stands_the_median(made):
    seeds = [seed_of(first, of(50), {"mass": of(50)}, {}) for first in (2000, 4000, 3000)]
    assert made.row(seeds, asked=0.7, steps=STEPS)["learn_s"] == pytest.approx(6.0)


def test_who_never_walks_has_no_speed(made):
    row = made.row([seed_of(None, of(3), {"mass": of(3)}, {})], asked=0.7, steps=STEPS)
    assert row["learn_s"] is row["speed"] is row["cost"] is None
    assert (row["samples"], row["range"], row["undisturbed"]) == ("-", "none", "1 of 1")


def test_the_first_walk_is_the_first_of_the_curve(made):
    curve = seed_of(3000, of(50), {}, {})["curve"]
    assert made.first_walk(curve, WHOLE) == (3000, 6.0)
    assert made.first_walk(curve, WHOLE + 1) is None
