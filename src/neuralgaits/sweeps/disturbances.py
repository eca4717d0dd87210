"""Disturbances of a sweep: the standard set, or those of a file.

The file is TOML with one table for each disturbance; keys are those of `simulate --disturb`:

    ["floor +-1 cm"]
    floor_height = 0.01
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from neuralgaits._inputs import toml_of
from neuralgaits._printable import shown
from neuralgaits.errors import InputError, reason
from neuralgaits.records.swept import UNDISTURBED
from neuralgaits.runs import plain
from neuralgaits.simulation.setup.disturbance import PlantChanges, parse
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET

STANDARD = "standard"
_ONE_TABLE_EACH = (
    'a table for each disturbance under its own name, as in ["floor +-1 cm"] with '
    "floor_height = 0.01 below it"
)


def disturbances_of(source: str | Path | Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the requested disturbances of the plant by name, as plain values.

    Args:
        source: `standard` for the eighteen of `simulation.setup.disturbance_set`, `none` for no
            disturbance, a TOML file, or a mapping of names to disturbances.

    Raises: InputError in one line.
    """
    if isinstance(source, str) and source in (STANDARD, UNDISTURBED):
        tables: Mapping[str, Any] = DISTURBANCE_SET if source == STANDARD else {}
    else:
        tables = _read(Path(source)) if isinstance(source, str | Path) else source
    if UNDISTURBED in tables:
        raise InputError(
            f"expected disturbances of other names than {UNDISTURBED!r}, found it: every gait "
            "walks without one as well; give it another name"
        )
    return {name: plain(vars(_parsed(name, one))) for name, one in tables.items()}


def _parsed(name: Any, one: Any) -> PlantChanges:
    if isinstance(one, Mapping):
        fits = not any(isinstance(value, Mapping) for value in one.values())
    else:
        fits = isinstance(one, str | PlantChanges)
    if not fits:
        raise InputError(
            f"disturbance {name!r}: expected a table of names and numbers, found {shown(one)}: "
            f"write {_ONE_TABLE_EACH}"
        )
    if not (isinstance(name, str) and name.strip() and name.isprintable()):
        raise InputError(f"expected a disturbance with a name of one line, found {name!r}")
    return parse(one)


def _read(path: Path) -> dict[str, Any]:
    try:
        table = toml_of(path)
    except OSError as error:
        raise InputError(
            f"expected --disturbances {STANDARD}, {UNDISTURBED} or a TOML file, found {path}: "
            f"{reason(error)}"
        ) from None
    except ValueError as error:
        raise InputError(
            f"expected TOML in {path}, found what cannot be read ({error}): write {_ONE_TABLE_EACH}"
        ) from None
    if not table:
        raise InputError(
            f"expected disturbances in {path}, found none: --disturbances {UNDISTURBED} is for that"
        )
    return table
