"""Settings of several verbs: what makes no sense is refused in one line."""

import math

import pytest

from neuralgaits import _checks as settings
from neuralgaits.errors import InputError


@pytest.mark.parametrize(
    ("check", "good", "bad"),
    [
        (settings.check_seed, [(0,), (2**31 - 1,)], [(-1,), (2**31,)]),
        (settings.check_steps, [(None,), (1,)], [(0,), (-5,), (10**40,), (10**400,)]),
        (settings.check_seed, [(7,)], [(10**400,)]),
        (settings.check_push, [(None,), (-64.0,)], [(math.nan,), (math.inf,), (1e308,)]),
        (settings.check_widths, [(None,), ((32, 32),)], [((),), ((8, 0),), ((10**400,),)]),
        (settings.check_widths, [((4096,),)], [((1,) * 9,), ((4097,),)]),
        (
            settings.check_disturbance,
            [((0.0, 0.0),), ((0.1, 2.0),)],
            [((-0.1, 0.0),), ((0.0, math.inf),), ((math.nan, 0.0),)],
        ),
        (settings.check_budget, [(None,), (0.5,)], [(0.0,), (-1.0,), (math.nan,), (math.inf,)]),
        (
            settings.check_proof_budget,
            [(True, 5.0), (False, None)],
            [(False, 5.0), (True, 0.0)],
        ),
    ],
)
def test_only_what_makes_sense_passes(check, good, bad):
    for arguments in good:
        check(*arguments)
    for arguments in bad:
        with pytest.raises(InputError, match=r"^(--steps: )?expected .*found"):
            check(*arguments)
