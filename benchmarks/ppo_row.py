"""The row of reinforcement learning: what `examples/ppo.py` found with some seeds, as a whole."""

import statistics
from collections.abc import Iterable
from typing import Any

WALKED = "walked"


def first_walk(curve: Iterable[dict[str, Any]], steps: int) -> tuple[int, float] | None:
    """When a trial first walked so many steps.

    Returns: samples and processor time until then (s); None if none did.
    """
    for point in curve:
        if max(point.get(WALKED, ()), default=0) >= steps:
            return point["samples"], point["processor_s"]
    return None


def fell(trials: Iterable[dict[str, Any]], steps: int) -> tuple[int, int]:
    """Of trials of any kind, those that did not walk so many steps, and all."""
    walked = [count >= steps for one in trials for count in one[WALKED]]
    return walked.count(False), len(walked)


def which(found: dict[str, tuple[int, int]]) -> str:
    """What was fallen under how often, most often first, from falls and walks under each."""
    often = sorted(found.items(), key=lambda one: -one[1][0] / one[1][1])
    return ", ".join(f"{name} {down} of {count}" for name, (down, count) in often if down)


def kept_speeds(found: dict[str, Any]) -> list[tuple[float, float]]:
    """Speeds asked for at which every trial walked all its steps, and what was walked (m/s)."""
    return [
        (float(asked), one["speed_m_s"])
        for asked, one in found["speeds"].items()
        if fell([one], one["steps"])[0] == 0 and one["speed_m_s"] is not None
    ]


def row(seeds: list[dict[str, Any]], *, asked: float, steps: int) -> dict[str, Any]:
    """Fields of a `peers.Row`.

    Speed and cost are medians over the seeds that walked what their trials had to; the first walk
    is of as many steps.

    Args:
        seeds: what `examples/ppo.py` wrote, one of each seed.
        asked: speed of the trials under disturbances (m/s).
        steps: without which a trial is a fall.
    """
    free = [one["speeds"][f"{asked:g}"] for one in seeds]
    whole = free[0]["steps"]
    firsts = [first for one in seeds if (first := first_walk(one["curve"], whole)) is not None]
    walks = [one for one in free if one["speed_m_s"] is not None]
    down = {
        name: fell((one["disturbed"][name] for one in seeds), steps)
        for name in seeds[0]["disturbed"]
    }
    undisturbed = fell(free, steps)
    ends = [one["curve"][-1] for one in seeds]
    samples = _spread([first[0] / 1e6 for first in firsts], "{:.2f}") if firsts else "none"
    return {
        "learn_s": _median([first[1] for first in firsts]),
        "samples": f"{samples} M environment steps of 20 ms" if firsts else "-",
        "speed": _median([one["speed_m_s"] for one in walks]),
        "cost": _median([one["cost_of_transport"] for one in walks]),
        "fell": sum(one[0] for one in down.values()),
        "walks": sum(one[1] for one in down.values()),
        "under": which(down),
        "undisturbed": f"{undisturbed[0]} of {undisturbed[1]}",
        "range": "; ".join(_range_of(one) for one in seeds),
        "note": f"{len(firsts)} of {len(seeds)} seeds walked {whole} steps at some time; each "
        f"learned from {_spread([end['samples'] / 1e6 for end in ends], '{:.2f}')} M steps, "
        f"{_spread([end['processor_s'] for end in ends], '{:.0f}')} s",
    }


def _range_of(found: dict[str, Any]) -> str:
    kept = kept_speeds(found)
    if not kept:
        return "none"
    asked, walked = zip(*kept, strict=True)
    return f"speed {', '.join(map('{:.2g}'.format, asked))}: {_spread(walked, '{:.2f}')} m/s walked"


def _spread(values: Iterable[float], form: str) -> str:
    """From the smallest to the largest; one number where they look the same."""
    values = list(values)
    low, high = form.format(min(values)), form.format(max(values))
    return low if low == high else f"{low} to {high}"


def _median(values: list[float]) -> float | None:
    return statistics.median(values) if values else None
