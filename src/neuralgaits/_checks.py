"""Checks of settings that several verbs share, each refused in one line if it makes no sense."""

import math
from numbers import Integral

from neuralgaits._printable import shown
from neuralgaits.errors import InputError

MOST_WALKED = 1_000_000
"""Limit on the walking steps of an episode, and on episodes: a million steps are five days."""
MOST_GRADIENT_STEPS = 10_000_000
MOST_WIDTH = 4096
"""Limit on the width of a policy's hidden layers: wider ones need more memory than there is."""
MOST_LAYERS = 8
"""Limit on the number of a policy's hidden layers."""
MOST_PUSH = 10_000.0
"""Largest impulse of a push [N s]: a car at walking pace."""
MOST_SEEDS = 10_000
"""Limit on the seeds of one command, each of which is a training."""
SEEDS = 2**31
"""Number of seeds: a run's is below, so this one draws samples that no training has."""
MOST_ROUNDS = 100
"""Limit on the rounds of `episodes`: a larger number is a slip of the finger, or damage."""


def listed(what: str, text: str) -> list[str]:
    """Split a list at its commas, without the blanks around its parts.

    Raises: InputError, which begins with `what`, if a part is empty: some word is missing.
    """
    parts = [part.strip() for part in text.split(",")]
    if not all(parts):
        raise InputError(
            f"{what}: expected NAME=VALUE,..., found {text!r} with nothing before or after a "
            "comma: drop the comma, or write what is missing"
        )
    return parts


def check_walking_steps(steps: object) -> None:
    """Check the number of walking steps of an episode. Raises: InputError unless it is 1 or more.

    A walk checks it again; here it is refused before anything is opened.
    """
    if not isinstance(steps, Integral) or steps < 1:
        raise InputError(f"--steps: expected a whole number of at least 1, found {steps!r}")


def check_walked(name: str, count: int) -> None:
    """Check numbers of walking steps and episodes. Raises: InputError if they take too long."""
    if count > MOST_WALKED:
        raise InputError(f"{name}: expected at most {MOST_WALKED}, found {shown(count)}")


def check_seed(seed: int) -> None:
    """Check a seed. Raises: InputError unless JAX and NumPy both take it."""
    if not 0 <= seed < SEEDS:
        raise InputError(f"expected a seed from 0 to {SEEDS - 1}, found {shown(seed)}")


def check_seeds(seeds: tuple[int, int]) -> None:
    """Check a range of seeds, its last one excluded. Raises: InputError on a wrong one."""
    first, end = seeds
    if not first < end:
        raise InputError(f"expected seeds A:B with A < B, found {shown(first)}:{shown(end)}")
    check_seed(first)
    check_seed(end - 1)
    if end - first > MOST_SEEDS:
        raise InputError(f"expected at most {MOST_SEEDS} seeds, found {end - first}")


def check_steps(steps: int | None) -> None:
    """Check a number of gradient steps; None leaves it open. Raises: InputError if it is wrong."""
    if steps is not None and steps < 1:
        raise InputError(f"--steps: expected a whole number of at least 1, found {shown(steps)}")
    if steps is not None and steps > MOST_GRADIENT_STEPS:
        raise InputError(
            f"--steps: expected at most {MOST_GRADIENT_STEPS} gradient steps, found {shown(steps)}"
        )


def check_widths(hidden: tuple[int, ...] | None) -> None:
    """Check widths of hidden layers; None leaves them open.

    Raises: InputError unless a network of these hidden layers can be made.
    """
    if hidden is None:
        return
    if not hidden or min(hidden) < 1:
        raise InputError(f"expected hidden widths of at least 1, found {shown(hidden)}")
    if len(hidden) > MOST_LAYERS or max(hidden) > MOST_WIDTH:
        raise InputError(
            f"expected at most {MOST_LAYERS} hidden widths of at most {MOST_WIDTH}, found "
            f"{len(hidden)}, the largest {shown(max(hidden))}"
        )


def check_walks(episodes: int, seed: int, push: float | None) -> None:
    """Check the number of episodes, how they are drawn, and their pushes (N s).

    Raises: InputError unless they can be walked so.
    """
    if episodes < 1:
        raise InputError(f"expected at least 1 episode, found {shown(episodes)}")
    check_seed(seed)
    check_walked("episodes", episodes)
    check_push(push)


def check_push(push: float | None) -> None:
    """Check the impulse of a push (N s); None is no push. Raises: InputError if it is too large."""
    if push is not None and not abs(push) <= MOST_PUSH:
        raise InputError(
            f"expected a push of -{MOST_PUSH:g} to {MOST_PUSH:g} N s, found {push:g}: give an "
            "impulse in that range, as in --push 10, or leave --push out"
        )


def check_rounds(rounds: int | None) -> None:
    """Check a number of rounds; None leaves it open. Raises: InputError if they take too long."""
    if rounds is not None and not 1 <= rounds <= MOST_ROUNDS:
        raise InputError(f"expected 1 to {MOST_ROUNDS} rounds, found {shown(rounds)}")


def check_disturbance(bounds: tuple[float, float]) -> None:
    """Check bounds of a disturbance of dz (m/s, N m). Raises: InputError if they are impossible."""
    if not all(0.0 <= bound < math.inf for bound in bounds):
        raise InputError(f"expected a disturbance of two bounds >= 0 (m/s, N m), found {bounds}")


def check_bandwidth(bandwidth: float) -> None:
    """Check a bandwidth (rad/s). Raises: InputError unless outputs can converge so fast."""
    # Slower outputs outlast a step, and a controller at 1 kHz has none that are faster.
    slowest, fastest = 1.0, 1000.0
    if not slowest <= bandwidth <= fastest:
        raise InputError(
            f"expected a bandwidth of {slowest:g} to {fastest:g} rad/s, found {bandwidth:g}: write "
            "--bandwidth 50"
        )


def check_error(error: float) -> None:
    """Check an error of the outputs' acceleration (rad/s^2). Raises: InputError if impossible."""
    if not 0.0 <= error < math.inf:
        raise InputError(
            f"expected an error of 0 rad/s^2 or more, found {error:g}: write --error 0.1"
        )


def check_state_error(error: tuple[float, float]) -> None:
    """Check errors of measured angles and rates (rad, rad/s). Raises: InputError if impossible."""
    if not all(0.0 < part < math.inf for part in error):
        raise InputError(
            "expected errors of angles and rates of more than 0 rad and 0 rad/s, found "
            f"{error[0]:g} rad, {error[1]:g} rad/s: write --state-error 0.005mrad,0.25mrad/s"
        )


def check_budget(budget: float | None) -> None:
    """Check a time budget; None leaves it open. Raises: InputError unless it is more than 0 s."""
    if budget is not None and not 0.0 < budget < math.inf:
        raise InputError(f"expected a budget of more than 0 seconds, found {budget}")


def check_proof_budget(certify: bool, budget: float | None) -> None:
    """Check the time budget of a proof, which makes sense only if a proof is requested.

    Raises: InputError if the budget makes no sense, or is given without a proof.
    """
    if budget is not None and not certify:
        raise InputError("expected a budget with --certify only, found it alone: add --certify")
    check_budget(budget)
