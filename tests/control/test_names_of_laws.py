"""A law has a name wherever one can be asked for."""

from typing import get_args, get_type_hints

import pytest

from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits.cli import arguments
from neuralgaits.control import AbstractLaw
from neuralgaits.control.law_by_name import exported_laws, law_named
from neuralgaits.errors import InputError
from neuralgaits.records.episode_records import EpisodesConfig
from neuralgaits.simulation.incompatible_settings import REMOTE


def test_the_command_line_knows_every_law():
    assert get_args(get_type_hints(arguments.SimulateOptions)["controller"]) == (
        *CONTROL_LAWS,
        REMOTE,
    )


def test_episodes_are_read_back_under_every_law():
    assert get_args(get_type_hints(EpisodesConfig)["controller"]) == tuple(CONTROL_LAWS)


def test_a_law_is_found_by_its_name_or_is_itself():
    for name in CONTROL_LAWS:
        law = law_named(name)
        assert isinstance(law, AbstractLaw) and law_named(name) is law_named(law) is law
    assert set(exported_laws()) < set(CONTROL_LAWS)
    with pytest.raises(InputError, match="expected one of pd, fblin, paper, clf-qp"):
        law_named("pid")


@pytest.mark.parametrize("named", [["pd"], 3, None])
def test_what_is_no_name_is_no_law(named):
    with pytest.raises(InputError, match=r"unknown controller .*: expected one of pd, "):
        law_named(named)
