"""What a quantity of a log is called in its file, so that a message can name the column.

A quantity has a leg of its own in files that keep the legs apart: `q_stance_knee` is the left
knee while the left leg stands.
"""

from collections.abc import Mapping

Labels = Mapping[str, tuple[str, str]]
"""By name of `walk_table.columns`: the file's column while leg 0 stands, and while leg 1 does."""


def same_for_both_legs(names: Mapping[str, str]) -> Labels:
    """Labels of a file whose columns are those of the stance leg."""
    return {name: (label, label) for name, label in names.items()}
