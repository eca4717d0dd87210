"""Every verb of the command line is carried out by some function."""

import re
from typing import get_args

import pytest

from neuralgaits.cli import verbs
from neuralgaits.cli.argv_parser import Verb, read, verb_name


def test_each_verb_has_its_function():
    """A verb without one would end as a defect of the program."""
    assert set(verbs._CARRY_OUT) == set(get_args(Verb))


def test_the_help_names_each_verb_by_what_it_is_for(capsys):
    with pytest.raises(SystemExit):
        read(["--help"])
    groups = capsys.readouterr().out.partition("To begin:")[2].partition("options")[0]
    named = re.findall(r"[a-z][a-z-]+", groups)
    for verb in get_args(Verb):
        assert named.count(verb_name(verb)) == 1, verb_name(verb)
