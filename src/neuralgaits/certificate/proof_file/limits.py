"""Limits on the size of a proof file, above those of any gait's proof.

A short text can ask for work that grows with the square of its length, or for more memory than
there is. A file beyond these limits is refused before the work is done.
`tools/proofcheck/reading.hpp` has the same limits in the same words.

The bytes of a file, unpacked, are limited in `runs/packed.py`; depth and digits of JSON by
`json_fields.py`, with the numbers below; halvings of one axis by `MAX_CUTS` in `reader.py`.
"""

MOST_FIELDS = 1000
"""Most fields of a JSON object."""
MOST_NAMES = 1000
"""Most names in one list, as of conditions."""
MOST_OUTPUTS = 4000
"""Most outputs of a Program."""
MOST_STATEMENTS = 1000
MOST_LEAVES = 2**23
"""Most leaves of all trees together. In memory each leaf is two corners: 32 bytes in two axes, 256
in sixteen. A packed file of 100 kB could ask for 2^25 of them; no proof of a gait had 2^22."""
MOST_OF_OUTPUT = 1000
"""Most elements of an output of a Program."""
MOST_BOXES = 32
"""Most boxes of a region; whether they cover the chart is checked between all of their edges."""
MOST_DIMENSIONS = 8
"""Most dimensions of an array of a Program; the chart may have more axes."""
MOST_SERIES = 1000
"""Most numbers of one constant of a theorem."""
MOST_COMMANDS = 7
DEEPEST = 60
"""Most levels of JSON inside each other."""
MOST_WORK = 2**23
"""Most numbers that the operations of a Program read, multiply and make."""
MOST_DIGITS = 9
"""Most digits of a whole number."""
SHOWN = 600
"""Most characters of a complaint, which may quote as much as the whole file."""


def limit(count: int, most: int, what: str) -> None:
    """Refuse too many of something. Raises: ValueError."""
    if count > most:
        raise ValueError(f"more than {most} {what}")


def shortened(text: str) -> str:
    """Return the beginning of a complaint, of no more than `SHOWN` characters."""
    return text if len(text) <= SHOWN else f"{text[:SHOWN]} ..."
