"""Streams of random numbers: one for each thing that is drawn of an episode, all independent.

A new thing takes a number that is free. `robots.mjcf.drawn_robots` draws per robot instead of per
episode; its own number comes first in its seeds, so it meets none of these.
"""

from enum import IntEnum

import numpy as np


class Stream(IntEnum):
    """Things that are drawn at random in an episode, each with its number.

    Numbers stay as they are, so that a seed goes on drawing the same walks.
    """

    START = 0
    FLOOR = 1
    PUSH = 2
    NOISE = 3
    COMMANDS = 6
    TERRAIN = 7


def generator(seed: int, episode: int, stream: Stream) -> np.random.Generator:
    """Return the random numbers of one thing in one episode."""
    return np.random.default_rng([seed, episode, stream])
