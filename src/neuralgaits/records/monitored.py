"""Answers of the monitor about walks: a part of the result of `simulate --monitor`."""

from collections.abc import Mapping
from dataclasses import dataclass

from neuralgaits.records.record import Count, Share


def margin_in_words(name: str) -> str:
    """Return the name of a margin for a page; a barrier keeps its own name."""
    words = {
        "phase-start": "start of the step",
        "phase-end": "end of the step",
        "direction": "forward direction",
        "level-lower": "slow edge",
        "level-upper": "fast edge",
        "foot": "swing foot above the ground",
        "output-error": "joints near their targets",
    }
    return words.get(name, name.replace("-", " "))


@dataclass(frozen=True)
class TickOutside:
    """A tick whose state is outside of a set.

    Attributes:
        walk: number of the walk.
        time_s: time of the tick [s].
        name: name of its smallest margin.
        margin: value of that margin.
    """

    walk: Count
    time_s: float
    name: str
    margin: float


@dataclass(frozen=True)
class LevelOccupancy:
    """States of walks and the set of one level.

    Attributes:
        inside: share of ticks whose state is in the set.
        margin, name: smallest margin of any tick, and its name; the margin is -1e30 where it is no
            number.
        last_outside: last tick outside, of the last walk that has one; None without.
    """

    inside: Share
    margin: float
    name: str
    last_outside: TickOutside | None = None


@dataclass(frozen=True)
class MonitorFigures:
    """States of walks and the sets that are proved of the gait.

    Attributes:
        ticks: number of control ticks of all walks.
        levels: occupancies by number of the level.
        admissible: share of ticks whose commands are in the proved ranges and changes.
        in_time: share of ticks no later than the proved hold of level 5; None if none is proved.
        proof_sha256: sha256 of the proof file that the sets are from.
    """

    ticks: Count
    levels: Mapping[str, LevelOccupancy]
    admissible: Share
    in_time: Share | None
    proof_sha256: str

    @property
    def by_set(self) -> list[tuple[str, LevelOccupancy]]:
        """Return levels as words, such as `4, 5`, those of one set together, lowest first."""
        groups: list[tuple[list[str], LevelOccupancy]] = []
        for level, one in self.levels.items():
            if groups and groups[-1][1] == one:
                groups[-1][0].append(level)
            else:
                groups.append(([level], one))
        return [(", ".join(levels), one) for levels, one in groups]
