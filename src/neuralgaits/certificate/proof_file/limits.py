"""How much of a thing a proof file may have: more than any gait's proof has.

A short text can ask for work that grows with the square of its length, or for more memory than
there is. Whatever asks for more than this is refused before the work is done.
`tools/proofcheck/reading.hpp` has the same limits in the same words.
"""

MOST_FIELDS, MOST_NAMES, MOST_OUTPUTS, MOST_STATEMENTS = 1000, 1000, 4000, 1000
MOST_OF_OUTPUT = 1000
"""Elements of an output of a Program."""
MOST_BOXES = 32
"""Of a region: whether they cover the chart is looked for between all of their edges."""
MOST_DIMENSIONS, MOST_SERIES, MOST_COMMANDS, DEEPEST = 8, 1000, 7, 60
MOST_WORK = 2**23
"""Numbers that the operations of a Program read, multiply and make."""
MOST_DIGITS = 9
"""Of a whole number."""
SHOWN = 600
"""Characters of a complaint: what it quotes may be as long as the file."""


def limit(count: int, most: int, what: str) -> None:
    """Refuse too many of something. Raises: ValueError."""
    if count > most:
        raise ValueError(f"more than {most} {what}")


def shortened(text: str) -> str:
    """The beginning of a complaint."""
    return text if len(text) <= SHOWN else f"{text[:SHOWN]} ..."
