"""TOML that a user gives: what nothing can use is refused in one line, whoever reads it."""

from pathlib import Path

import pytest

from neuralgaits._inputs import toml_of
from neuralgaits.errors import InputError
from neuralgaits.logs.formats.column_file import read_columns
from neuralgaits.robots import load_robot
from neuralgaits.sweeps.disturbances import disturbances_of

NESTED = "x = " + "[" * 20_000 + "]" * 20_000
ENDLESS = f"[a]\nfriction = {'9' * 5000}\n"
HUGE = f"[a]\nfriction = {'9' * 400}\n"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (NESTED, "nested too deeply"),
        (HUGE, "a number that is too large, a.friction"),
        (ENDLESS, "a number that is too large, of 5000 digits, in line 2"),
    ],
)
def test_deep_nesting_and_huge_numbers_are_refused(text: str, found: str, tmp_path: Path) -> None:
    path = tmp_path / "given.toml"
    path.write_text(text)
    with pytest.raises(ValueError, match=found):
        toml_of(path)
    with pytest.raises(InputError, match=found):
        disturbances_of(path)
    with pytest.raises(InputError, match=found):
        read_columns(path, load_robot("amber3m"))


def test_what_can_be_used_is_read(tmp_path: Path) -> None:
    path = tmp_path / "given.toml"
    path.write_text("[a]\nfriction = 0.4\nlevels = [1, 2]\n")
    assert toml_of(path) == {"a": {"friction": 0.4, "levels": [1, 2]}}
