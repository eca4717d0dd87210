"""Every verb of the command line is carried out by some function."""

from typing import get_args

from neuralgaits.cli import verbs
from neuralgaits.cli.argv_parser import Verb


def test_each_verb_has_its_function():
    """A verb without one would end as a defect of the program."""
    assert set(verbs._CARRY_OUT) == set(get_args(Verb))
