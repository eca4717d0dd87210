"""The levels of a proof: what each is about, in words for readers."""

from typing import NamedTuple


class LevelWords(NamedTuple):
    """Words about one level.

    Attributes:
        about: name of the level.
        asks: what must be proved in addition to the levels below.
        states: statement about a gait, as in docs/guarantees.md; below level 4 without `ON_TARGET`,
            which holds for all of them.
        means: meaning if it is the highest proved level, for a reader who knows none of the terms.
        states_told, means_told: likewise for a gait that takes commands, where that differs.
        one_gait: whether it is about a single gait of one robot on the intended floor, so that it
            covers no gait with commands and no box of robots or floors.
    """

    about: str
    asks: str
    states: str
    means: str
    states_told: str | None = None
    means_told: str | None = None
    one_gait: bool = False

    def statement(self, *, with_commands: bool) -> str:
        """Return the statement about a gait, which takes commands if `with_commands`."""
        return (self.states_told if with_commands else None) or self.states

    def meaning(self, *, with_commands: bool) -> str:
        """Return the meaning for a gait, which takes commands if `with_commands`."""
        return (self.means_told if with_commands else None) or self.means


WALKING_SET_LEVEL, ORBIT_LEVEL, FULL_ORDER_LEVEL, DISTURBED_LEVEL = 2, 3, 4, 5
"""Levels by name: the walking set is invariant, walks in it converge, the full state under exact
linearisation, the full state under torques that differ from that."""
ON_TARGET = "with joints exactly on target"
"""Premise of the levels below 4."""
FOR_EVER = (
    "as long as the joints are exactly where the gait wants them, the robot walks for ever from "
    "every state of the walking set"
)
WORDS = {
    1: LevelWords(
        about="conditions",
        asks=f"{ON_TARGET}, every condition on its region",
        states="every condition holds at every state of its region",
        means="every condition holds at every state of its region. That is about single states: "
        "nothing follows yet for whole walks.",
    ),
    WALKING_SET_LEVEL: LevelWords(
        about="walking set",
        asks="and that the walking set is invariant",
        states="every trajectory that starts in the walking set walks for ever",
        means=f"{FOR_EVER}.",
        states_told="from every state of the walking set the zero dynamics walk for ever, however "
        "their commands change within their bounds",
        means_told=f"{FOR_EVER}, whatever its commands are within their bounds.",
    ),
    ORBIT_LEVEL: LevelWords(
        about="orbit",
        asks="and that one orbit attracts all of it",
        states="one periodic orbit attracts the whole walking set",
        means=f"{FOR_EVER}, and comes nearer and nearer to one motion that repeats.",
        states_told="any two walks in the walking set under the same commands come together",
        means_told=f"{FOR_EVER}, whatever its commands are within their bounds, and walks under "
        "the same commands come nearer and nearer to each other.",
    ),
    FULL_ORDER_LEVEL: LevelWords(
        about="full order",
        asks="and that the rigid robot, under exact linearisation in continuous time, walks on "
        "from a set of states with joints off target, across impacts",
        states="the rigid robot under exact linearisation in continuous time walks for ever from "
        "a set D, joints off target included",
        means="under one control law, exact input-output linearisation in continuous time, and as "
        "long as the motors do at once exactly what it asks, the rigid robot walks for ever from "
        "every state of a set in which joints may be a little off target. With joints exactly on "
        "target, it comes nearer and nearer to one motion that repeats.",
        one_gait=True,
    ),
    DISTURBED_LEVEL: LevelWords(
        about="full order, disturbed",
        asks="and does so under torques that are not exact, or held for a time that is found",
        states="the rigid robot walks for ever from a set D under torques that are off the proved "
        "control law's (exact linearisation or scheduled-pd) by up to a bound, or held between "
        "ticks",
        means="the rigid robot walks for ever from every state of a set in which joints may be a "
        "little off target, as long as the torques differ from those of the proved control law "
        "(exact input-output linearisation or scheduled-pd) by no more than a bound; or as long as "
        "that law asks anew at each touchdown and within the time shown, and the motors hold that. "
        "With joints exactly on target, it comes nearer and nearer to one motion that repeats.",
        one_gait=True,
    ),
}
"""Words by the number of the level."""
HIGHEST = max(WORDS)
HIGHEST_OF_MANY = max(number for number, words in WORDS.items() if not words.one_gait)
"""Highest level that covers gaits with commands, and boxes of robots or floors."""
