"""Gaits of AMBER-3M that were published with their numbers: amber3m_gaits.json says where."""

import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits.gait import BezierPolicy

GAITS = json.loads(Path(__file__).with_name("amber3m_gaits.json").read_text())["gaits"]


def published(name: str) -> tuple[BezierPolicy, np.ndarray]:
    """Policy of a gait, and its full state after touchdown. [10]."""
    gait = GAITS[name]
    end, begin = gait["p"]
    policy = BezierPolicy(np.array(gait["bezier"]), (begin, end))
    x = np.array(gait["x_plus"])
    return jax.tree.map(jnp.asarray, policy), np.concatenate([x[2:7], x[9:14]])
