"""Names of a log's quantities in its file, so that a message can name the column.

A quantity has a column for each leg in files that keep the legs apart: `q_stance_knee` is the left
knee while the left leg is in stance.
"""

from collections.abc import Mapping

Labels = Mapping[str, tuple[str, str]]
"""Map from names of `table.s` to the file's s: while leg 0 is in stance, and
while leg 1 is."""


def same_for_both_legs(names: Mapping[str, str]) -> Labels:
    """Return the labels of a file whose columns are those of the stance leg."""
    return {name: (label, label) for name, label in names.items()}
