"""Members of a family of robots as numbers, to compare with robots that were loaded from files."""

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.mjcf.parameters import RobotFamily


def in_float64(family: RobotFamily, p: Float[np.ndarray, " k"]) -> PlanarBiped:
    """A member of the family with NumPy leaves like those of a loaded robot."""
    return jax.tree.map(np.asarray, family.at(jnp.asarray(p)))
