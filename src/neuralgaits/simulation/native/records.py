"""Convert records of compiled walks to `TickRecord`, which all other code reads."""

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array
from neuralgaits.control import Measurement, TickResult
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.simulation.ticks.sensors import true_z
from neuralgaits.simulation.ticks.tick import TickRecord


def record_of(rows: np.ndarray, plant_robot: SensedRobot) -> TickRecord:
    """Return a `TickRecord` with a leading axis of ticks.

    Args:
        rows: rows of `ng_record`. [T]
        plant_robot: robot that gives z with the plant's own masses.
    """
    leg = rows["leg"].astype(np.int32)
    since = rows["since_touchdown"]
    has_commands = "told" in (rows.dtype.names or ())
    # Value of NG_NEVER: time since a touchdown while there is none [s].
    result = TickResult(
        torque=rows["torque"],
        actuated=rows["actuated"],
        q=rows["q"],
        dq=rows["dq"],
        y_d=rows["y_d"],
        dy_d=rows["dy_d"],
        z=rows["z"],
        leg=leg,
        since_touchdown=np.where(since >= 1e30, np.inf, since),
        touchdown=rows["touchdown"] > 0.5,
        saturated=rows["saturated"] > 0.5,
        relaxed=rows["relaxed"] > 0.5,
        commands=rows["told"] if has_commands else np.zeros((len(rows), 2, 0)),
    )
    names = ("time", "pitch", "dpitch", "angles", "rates", "hip_velocity", "normal_force")
    truth = Measurement(*(rows[name] for name in names))
    z = np.asarray(_plant_z(plant_robot, _padded(truth), _padded(leg)))[: len(rows)]
    return TickRecord(rows["time"], result, rows["pitch"], rows["dpitch"], z)


@quick_filter_jit
def _plant_z(robot: SensedRobot, truth: Measurement, leg: Array) -> Array:
    return jax.vmap(lambda one, stance: true_z(robot, one, stance))(truth, leg)


def _padded(tree):
    """Pad to a power of two ticks, so that walks of all lengths share few compilations.

    A single tick, as live walks have it, stays alone.
    """

    def pad(leaf: np.ndarray) -> Array:
        longer = 1 if len(leaf) == 1 else 1 << max(10, (len(leaf) - 1).bit_length())
        return jnp.asarray(np.resize(leaf, (longer, *leaf.shape[1:])))

    return jax.tree.map(pad, tree)
