"""Every joint gets by with little mechanical power: two conditions beside those of `walking`."""

from neuralgaits.barriers import Pointwise, specs

POWER = 60.0  # W


def power(p):
    """Mechanical power of each joint [W]."""
    return p.torque * p.dq[1:]


def little_power(robot):
    """The spec; one scale is POWER."""
    return specs.walking(robot).with_conditions(
        Pointwise("power-upper", "tube", POWER, lambda p: POWER - power(p)),
        Pointwise("power-lower", "tube", POWER, lambda p: POWER + power(p)),
    )
