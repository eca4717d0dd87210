"""Tables of a proof file with a number or a hash for each name. All raise ValueError."""

from typing import Any

from neuralgaits._names import LONGEST_NAME
from neuralgaits.certificate.proof_file.json_fields import exactly, number_of, text_of


def named_hash(table: Any, what: str) -> tuple[str, str]:
    """Return a name and the hash beside it."""
    fields = exactly(table, what, ("name", "sha256"))
    name = text_of(fields["name"], f"{what} name")
    # Blanks could push words to the next line of a screen, where they look like ours.
    if len(name) > LONGEST_NAME or "  " in name:
        raise ValueError(f"the {what} name {name[:60]!r}, which is too long or has blanks in a row")
    return name, text_of(fields["sha256"], f"{what} sha256")


def scales_of(table: Any, names: list[str]) -> dict[str, float]:
    """Return a number > 0 for each name."""
    scales = _numbers(table, names, "scales")
    for name, value in scales.items():
        if not value > 0:
            raise ValueError(f"{value!r} among the scales, for {name}")
    return scales


def bounds_of(table: Any, names: list[str]) -> dict[str, float]:
    """Return a number for each name; that of a spec's condition must not be negative.

    The premises of theorems, `LEVEL/NAME`, may be constants enclosed from one side.
    """
    bounds = _numbers(table, names, "bounds")
    for name, value in bounds.items():
        if not value >= 0 and "/" not in name:
            raise ValueError(f"{value!r} among the bounds, for {name}")
    return bounds


def _numbers(table: Any, names: list[str], what: str) -> dict[str, float]:
    """Return a finite number for each name, exactly as in the file."""
    fields = exactly(table, what, names)
    return {name: number_of(value, f"{what}, for {name}") for name, value in fields.items()}
