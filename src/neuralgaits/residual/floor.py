"""Lower bound on a residual's error: a table over bins of z, which needs no training.

The error that remains with the table is no function of z, such as ringing of the outputs.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, ZeroState
from neuralgaits.gait import ZeroDynamics
from neuralgaits.logs import Windows
from neuralgaits.residual.trajectories import prediction_errors, root_mean_square


class Table(eqx.Module):
    """A piecewise constant rate of z; beyond its edges the outermost bins count.

    Attributes:
        low, high: corners of the box of bins (m, kg m^2/s). [2]
        values: rate in each bin (m/s, N m). [a, b, 2]
    """

    low: Float[Array, "2"]
    high: Float[Array, "2"]
    values: Float[Array, "a b 2"]

    def __call__(self, z: ZeroState) -> ZeroState:
        """Return the rate of the bin that contains z. Returns: [2] (m/s, N m)."""
        counts = jnp.array(self.values.shape[:2])
        place = jnp.floor((z - self.low) / (self.high - self.low) * counts).astype(int)
        first, second = jnp.clip(place, 0, counts - 1)
        return jnp.asarray(self.values)[first, second]


def binned(
    states: Float[np.ndarray, "N 2"], defects: Float[np.ndarray, "N 2"], bins: tuple[int, int]
) -> Table:
    """Return the table of each bin's mean defect; unvisited bins have none.

    Args:
        states: visited states (m, kg m^2/s).
        defects: missing rate there (m/s, N m).
        bins: along z1 and z2; divisors of 32 and 4.
    """
    low, high = states.min(axis=0), states.max(axis=0)
    # A state on the upper edge belongs to the last bin, and a box needs a width.
    high = high + 1e-9 * np.maximum(np.abs(high), 1.0)
    counts = np.array(bins)
    place = np.clip(((states - low) / (high - low) * counts).astype(int), 0, counts - 1)
    total, number = np.zeros((*bins, 2)), np.zeros(bins)
    np.add.at(total, tuple(place.T), defects)
    np.add.at(number, tuple(place.T), 1.0)
    values = total / np.maximum(number, 1.0)[..., None]
    # All tables are of one size, so one shape is compiled; coarse ones have repeated entries.
    for axis, (finest, coarse) in enumerate(zip((32, 4), bins, strict=True)):
        values = np.repeat(values, finest // coarse, axis=axis)
    return Table(low, high, values)


def floor(
    zd: ZeroDynamics,
    states: Float[np.ndarray, "N 2"],
    defects: Float[np.ndarray, "N 2"],
    judged_by: Windows,
    scale: Float[np.ndarray, "2"],
) -> float:
    """Return the error of the best table, in scaled z.

    Args:
        zd: robot and policy that walked; its own residual is ignored.
        states: states that fill the tables (m, kg m^2/s).
        defects: missing rate there (m/s, N m).
        judged_by: windows whose trajectories choose the table and give its error.
        scale: scale of z (m, kg m^2/s).
    """
    # Numbers of bins along z1 and z2 that are tried.
    tried = ((4, 1), (8, 1), (16, 1), (32, 1), (8, 2), (16, 2), (16, 4), (32, 4))
    tables = [binned(states, defects, bins) for bins in tried]
    return min(
        root_mean_square(prediction_errors(zd, table, judged_by).errors, scale) for table in tables
    )
