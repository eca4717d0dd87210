"""The default gait under few conditions: trains in seconds, and feels both residuals."""

from dataclasses import replace

from neuralgaits.barriers import specs

KEPT = (
    "torso-upper",
    "flow-above-lower-fence",
    "flow-below-upper-fence",
    "reset-above-lower-fence",
    "reset-below-upper-fence",
)


def brief(robot):
    return briefly(specs.walking(robot))


def briefly(spec):
    """Few of the conditions of `walking`."""
    conditions = tuple(c for c in spec.conditions if c.name in KEPT)
    return replace(spec, name="brief", conditions=conditions)
