"""Proof files about flat feet that somebody has altered: none is taken, by either checker."""

import copy
import json

import pytest

from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.proof_file.consistency import inconsistencies
from neuralgaits.certificate.proof_file.reader import read_claims
from support.checker_case import Case
from support.full_case import FullCase

ONE = (1.0).hex()


@pytest.fixture(scope="module")
def written():
    """The table of a proof file."""
    return json.loads(json.dumps(Case("amber3m-feet").table))


def ankle(table):
    return table["model"]["policy"]["ankle"]


def sole(table):
    return table["model"]["robot"]["sole"]


def pressure(table):
    return table["model"]["conditions"]["pressure_heel"]["quantity"]


ALTERED = {
    "no sole": lambda t: t["model"]["robot"].pop("sole"),
    "a sole without length": lambda t: sole(t).update(heel=ONE, toe=(-1.0).hex()),
    "a sole of text": lambda t: sole(t).update(heel="long"),
    "half a sole": lambda t: sole(t).pop("toe"),
    "more than a sole": lambda t: sole(t).update(ball=ONE),
    "no torso": lambda t: t["model"]["robot"].update(torso=None),
    "a foot alone": lambda t: t["model"]["robot"].update(leg=t["model"]["robot"]["leg"][:1]),
    "no ankle": lambda t: t["model"]["policy"].pop("ankle"),
    "an ankle of no layers": lambda t: ankle(t).update(layers=0),
    "an ankle with an array more": lambda t: ankle(t)["arrays"].update(
        least={"shape": [], "values": [ONE]}
    ),
    "an ankle without scale": lambda t: ankle(t)["arrays"].pop("input_scale"),
    "another array's constant": lambda t: ankle(t)["arrays"].update(
        most={"constant": "policy.z_guard"}
    ),
    "another end": lambda t: pressure(t).update(end="arch"),
    "no end": lambda t: pressure(t).pop("end"),
    "a share of text": lambda t: pressure(t).update(share="all"),
}


def taken(answer):
    """Whether a file was read and found to agree with itself: what it claims is bounded then."""
    last = (answer.stdout.splitlines() or [""])[-1]
    return answer.returncode != 2 and (not last.startswith("rejected: ") or " boxes, " in last)


def test_as_it_was_written_nothing_is_wrong(asked, written):
    assert taken(asked(written))


@pytest.mark.parametrize("change", ALTERED)
def test_what_is_altered_is_rejected(asked, written, change):
    table = copy.deepcopy(written)
    ALTERED[change](table)
    assert not taken(asked(table))


def test_level_4_of_flat_feet_is_rejected_by_both(asked, tmp_path, monkeypatch):
    """As a search would write it that lacks the refusal."""
    monkeypatch.setattr(FullOrderModel, "__post_init__", lambda self: None)
    path = FullCase("amber3m-feet").write(tmp_path / "proof.json")
    answer = asked(path.read_text())
    assert not taken(answer)
    assert "level 4 is stated, and it is about point feet" in answer.stdout
    claims = read_claims(path)
    assert "level 4 is stated, and it is about point feet" in inconsistencies(
        claims, claims.outline
    )
