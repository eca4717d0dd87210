"""Gaits of AMBER-3M that were published with their numbers: examples/gaits/amber3m.json."""

import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits.gait import BezierPolicy

FILE = Path(__file__).parents[2] / "examples" / "gaits" / "amber3m.json"
GAITS = json.loads(FILE.read_text())["gaits"]


def published(name: str) -> tuple[BezierPolicy, np.ndarray]:
    """Policy of a gait, and its full state after touchdown. [10]."""
    gait = GAITS[name]
    end, begin = gait["p"]
    policy = BezierPolicy(np.array(gait["bezier"]), (begin, end))
    x = np.array(gait["x_plus"])
    return jax.tree.map(jnp.asarray, policy), np.concatenate([x[2:7], x[9:14]])
