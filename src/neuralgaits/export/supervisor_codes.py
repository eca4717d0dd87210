"""Numbers of the supervisor in C (`supervisor.h`): modes, requests, reasons and waits."""

from enum import IntEnum


class Mode(IntEnum):
    """Mode of a supervised robot, `ng_mode` in C."""

    DAMP = 0
    STAND = 1
    WALK = 2
    STOP = 3


class Request(IntEnum):
    """Request of the operator, `ng_request` in C."""

    DAMP = 0
    STAND = 1
    WALK = 2


class Reason(IntEnum):
    """Why the mode has changed, `ng_reason` in C."""

    NO_CHANGE = 0
    AS_REQUESTED = 1
    FROM_MID_STEP = 2
    TIPS_FORWARD = 3
    SETTLED = 4
    TOO_LATE = 5
    TIPPED_OVER = 6
    BY_FAULT = 7
    FEET_HELD = 8


class Waiting(IntEnum):
    """Reason why a request waits, `ng_waiting` in C."""

    NOTHING = 0
    FOR_DAMP = 1
    FOR_LEGS = 2
    FOR_STANDING = 3
    FOR_TWO_FEET = 4
    FOR_POSTURE = 5
    FOR_REST = 6


def listed(codes: type[IntEnum]) -> str:
    """Return all numbers with their names in words, as in `0: damp, 1: stand`."""
    return ", ".join(f"{one.value}: {one.name.lower().replace('_', ' ')}" for one in codes)
