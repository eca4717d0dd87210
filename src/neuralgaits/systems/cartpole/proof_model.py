"""The object "model" of a cart-pole's proof file."""

from typing import Any

from neuralgaits.certificate.proof_file.array_tables import array_table, hexes
from neuralgaits.programs import Program
from neuralgaits.systems.cartpole.cartpole_run import CartPoleRun, arrays_of
from neuralgaits.systems.cartpole.state_regions import CONDITIONS, REGIONS


def model_data(run: CartPoleRun, program: Program) -> dict[str, Any]:
    """Return the object "model" of a proof: the numbers of file and run, nothing derived."""
    arrays = {
        owner: array_table(owner, own, program.parameters)
        for owner, own in arrays_of(run.controller).items()
    }
    return {
        "family": run.config.family,
        "robot": {name: x.hex() for name, x in run.data.numbers().items()},
        **{owner.removeprefix("controls."): own for owner, own in arrays.items()},
        "rate": run.config.rate.hex(),
        "regions": {
            name: [{"low": hexes(low), "high": hexes(high)} for low, high in boxes]
            for name, boxes in REGIONS.items()
        },
        "conditions": {
            name: {"kind": "Margin", "region": region, "scale": 1.0}
            for name, region in CONDITIONS.items()
        },
    }
