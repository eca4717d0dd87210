"""Optimiser and learning rate: the schedule during training, and the scale for a wider network."""

from dataclasses import replace

import jax
import optax

from neuralgaits.barriers import GaitSpec, Recipe
from neuralgaits.gait.policies.commanded_gait import AnyGait


def schedule(recipe: Recipe, steps: int) -> optax.Schedule:
    """Return the schedule: a rise from zero over the warm-up, then a cosine or drops to a tenth.

    Args:
        recipe: rate, warm-up and milestones.
        steps: gradient steps in all.
    """
    rate, warmup = recipe.learning_rate, round(recipe.warmup * steps)
    if recipe.milestones is None:
        later = optax.cosine_decay_schedule(rate, max(steps - warmup, 1))
    else:
        drops = {round(share * steps) - warmup: 0.1 for share in recipe.milestones}
        later = optax.piecewise_constant_schedule(rate, drops)
    rise = optax.linear_schedule(0.0, rate, max(warmup, 1))
    return optax.join_schedules([rise, later], [warmup]) if warmup else later


def optimizer_of(recipe: Recipe, steps: int, factor: float) -> optax.GradientTransformation:
    """Return the optimiser of a training: AdamW, with clipped gradients if the recipe says so.

    Args:
        recipe: rate, decay of weights and largest gradient.
        steps: gradient steps in all.
        factor: share of the recipe's rate.
    """
    rate = replace(recipe, learning_rate=factor * recipe.learning_rate)
    steps_of = optax.adamw(schedule(rate, steps), weight_decay=recipe.weight_decay)
    if recipe.largest_gradient is None:
        return steps_of
    return optax.chain(optax.clip_by_global_norm(recipe.largest_gradient), steps_of)


def width_factor(spec: GaitSpec, gait: AnyGait) -> float:
    """Return the share of the recipe's rate for the widths of a gait: at most 1.

    A recipe is made for the spec's own widths. A step of Adam moves every weight alike, so it
    changes the sums of a layer in proportion to its width at worst and to the root of it if the
    changes were independent. The root is enough: with `walking` on amber3m and two layers of 256,
    two of six seeds failed at the rate of a layer of 32 (one condition missed, one NaN), and
    none of six at the root of 32/256 of it.
    """
    widths = gait.policy.hidden_widths
    usual_widths = spec.new_gait(jax.random.key(0), "posture", None).policy.hidden_widths
    if not widths or not usual_widths or max(widths) <= max(usual_widths):
        return 1.0
    return (max(usual_widths) / max(widths)) ** 0.5
