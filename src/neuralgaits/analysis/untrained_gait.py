"""The gait that the training of a run starts from."""

import jax
from jaxtyping import PRNGKeyArray

from neuralgaits._inputs import same_folder
from neuralgaits.barriers import GaitSpec, specs
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.records.training_config import config_of
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import START


def untrained(folder: RunFolder, spec: GaitSpec) -> AnyGait:
    """Return the gait the run started from, before any posture steps."""
    gait = _new_gait(folder, spec, jax.random.key(config_of(folder).seed))
    if START not in folder.copies:
        return gait
    folder.copied(START)  # Refuses weights that were changed since.
    return folder.read_tree(START, gait)


def gait_of_shapes(folder: RunFolder, spec: GaitSpec) -> AnyGait:
    """Return a gait whose arrays have shapes and kinds but no values, for a run's weights.

    The values that training started from are left out: computing them takes a second. A user's own
    function may do with them as it likes, so it gets them.
    """
    if not specs.is_built_in(config_of(folder).spec):
        return untrained(folder, spec)
    shapes_kept = {}

    def shapes(key):
        leaves, shapes_kept["structure"] = jax.tree.flatten(_new_gait(folder, spec, key))
        shapes_kept["leaves"] = leaves
        return [leaf for leaf in leaves if isinstance(leaf, jax.Array)]

    shaped = iter(jax.eval_shape(shapes, jax.eval_shape(jax.random.key, 0)))
    leaves = [
        next(shaped) if isinstance(leaf, jax.Array) else leaf for leaf in shapes_kept["leaves"]
    ]
    return jax.tree.unflatten(shapes_kept["structure"], leaves)


@same_folder()
def _new_gait(folder: RunFolder, spec: GaitSpec, key: PRNGKeyArray) -> AnyGait:
    config = config_of(folder)
    return spec.new_gait(key, config.init, config.hidden)
