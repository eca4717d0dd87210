"""The object "model" of a cart-pole's proof file."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from neuralgaits.programs import Program
from neuralgaits.systems.cartpole.cartpole_run import CartPoleRun, arrays_of
from neuralgaits.systems.cartpole.state_regions import CONDITIONS, REGIONS


def model_data(run: CartPoleRun, program: Program) -> dict[str, Any]:
    """Return the object "model" of a proof: the numbers of file and run, nothing derived."""
    arrays = {
        owner: {
            name: _array(f"{owner}.{name}", np.asarray(value, dtype=np.float64), program)
            for name, value in own.items()
        }
        for owner, own in arrays_of(run.controller).items()
    }
    return {
        "family": run.config.family,
        "robot": {name: x.hex() for name, x in run.data.numbers().items()},
        **{owner.removeprefix("controls."): own for owner, own in arrays.items()},
        "rate": run.config.rate.hex(),
        "regions": {
            name: [{"low": _hex(low), "high": _hex(high)} for low, high in boxes]
            for name, boxes in REGIONS.items()
        },
        "conditions": {
            name: {"kind": "Margin", "region": region, "scale": 1.0}
            for name, region in CONDITIONS.items()
        },
    }


def _array(name: str, array: np.ndarray, program: Program) -> dict[str, Any]:
    """Return an array as the name of an identical constant of the Program, else as numbers."""
    known = program.parameters.get(name)
    if known is not None and known.tobytes() == array.tobytes():
        return {"constant": name}
    return {"shape": list(array.shape), "values": _hex(array.ravel())}


def _hex(values: Sequence[float] | np.ndarray) -> list[str]:
    return [float(value).hex() for value in values]
