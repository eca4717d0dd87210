"""Settings that several verbs have, each refused in one line if it makes no sense."""

import math

from neuralgaits.errors import InputError

MOST_ROUNDS = 100
"""Of episodes: what is more is a slip of the finger, or damage."""


def check_seed(seed: int) -> None:
    """Raises: InputError unless JAX and NumPy both take it."""
    if not 0 <= seed < 2**31:
        raise InputError(f"expected a seed from 0 to 2147483647, found {seed}")


def check_seeds(seeds: tuple[int, int]) -> None:
    """Raises: InputError unless there is a seed from the first up to the one before the last."""
    first, end = seeds
    if not first < end:
        raise InputError(f"expected seeds A:B with A < B, found {first}:{end}")
    check_seed(first)
    check_seed(end - 1)


def check_steps(steps: int | None) -> None:
    """Raises: InputError if there are no gradient steps; None leaves the number open."""
    if steps is not None and steps < 1:
        raise InputError(f"expected at least 1 gradient step, found {steps}")


def check_rounds(rounds: int | None) -> None:
    """Raises: InputError unless so many rounds of episodes can be waited for; None leaves it."""
    if rounds is not None and not 1 <= rounds <= MOST_ROUNDS:
        raise InputError(f"expected 1 to {MOST_ROUNDS} rounds, found {rounds}")


def check_disturbance(bounds: tuple[float, float]) -> None:
    """Raises: InputError unless they can bound what is added to dz (m/s, N m)."""
    if not all(0.0 <= bound < math.inf for bound in bounds):
        raise InputError(f"expected a disturbance of two bounds >= 0 (m/s, N m), found {bounds}")


def check_budget(budget: float | None) -> None:
    """Raises: InputError unless there are seconds to spend; None leaves them open."""
    if budget is not None and not 0.0 < budget < math.inf:
        raise InputError(f"expected a budget of more than 0 seconds, found {budget}")


def check_proof_budget(certify: bool, budget: float | None) -> None:
    """Raises: InputError also if a budget of a proof is given and no proof is asked for."""
    if budget is not None and not certify:
        raise InputError("expected a budget with --certify only, found it alone: add --certify")
    check_budget(budget)
