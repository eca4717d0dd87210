"""The default gait's statements: confirmed, and rejected once anything in them is not so."""

import base64
import copy
import json

import numpy as np
import pytest

from neuralgaits.programs import Program
from neuralgaits.workflows.check_proof import check_proof
from support.checker_case import holds


def claims(table):
    return {name: s for s in table["statements"] for name in s["conditions"]}


def hashed(table):
    """With the hash that the Program now has, and no other trace of the change."""
    table["program_hash"] = Program.from_json(json.dumps(table["program"])).hash
    return table


def constant(table, name: str, change) -> None:
    """Change a named array of the Program."""
    (row,) = [row for row in table["program"]["constants"] if row[0] == name]
    array = np.frombuffer(base64.b64decode(row[2])).reshape(row[1]).copy()
    row[2] = base64.b64encode(change(array).tobytes()).decode()


def test_the_default_proof_is_confirmed(proofcheck, proof_file, proof):
    """Statement by statement, with the meaning in words, and what follows from them."""
    answer = proofcheck(proof_file)
    assert answer.returncode == 0, answer.stdout
    lines = [line.strip() for line in answer.stdout.splitlines()]
    for name in claims(proof):
        stated = sum(name in statement["conditions"] for statement in proof["statements"])
        assert sum(line.startswith(f"{name}: ") and ">=" in line for line in lines) == stated
    torso = [line for line in lines if line.startswith("torso-lower: ")]
    assert "dh/dt + 10/s h >= 0." in torso[0]
    assert "torso angle" in torso[0] and "rad/s" in torso[0]
    assert ["level 2 proved", "level 3 proved"] == [x for x in lines if x.startswith("level ")]
    assert lines[-1].startswith("proved of the robot, policy and spec above: ")
    assert "level 2, level 3" in lines[-1]


def test_both_checkers_agree(asked, spoilt, tmp_path):
    """On the smallest statements: the other one takes seconds for the rest."""
    spoilt["statements"] = [s for s in spoilt["statements"] if len(s["tree"]) < 90]
    assert holds(asked(spoilt))
    found = check_proof(tmp_path / "proof.json")
    assert (
        found["verdict"] == "undecided" and "every statement of the file holds" in found["reason"]
    )
    more(spoilt)
    assert asked(spoilt).returncode == 1
    assert check_proof(tmp_path / "proof.json")["verdict"] == "rejected"


def test_the_default_proof_follows_from_its_program_too(proofcheck, proof_file, proof, tmp_path):
    answer = proofcheck("--program", proof_file)
    assert answer.returncode == 0, answer.stdout
    lines = answer.stdout.splitlines()
    assert ["level 2 consistent", "level 3 consistent"] == [x for x in lines if x[:6] == "level "]
    assert "nothing was derived from the robot's numbers" in lines[-1]
    # The theorem speaks of numbers that the Program computes with.
    table = copy.deepcopy(proof)
    table["theorems"][1]["parameters"]["expansion"][0] = "0x1p-3"
    for row in table["program"]["constants"]:
        row[0] = None if row[0] == "orbit.expansion" else row[0]
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(hashed(table)))
    answer = proofcheck("--program", path)
    assert answer.returncode == 1 and "not that of the Program" in answer.stdout


def test_leaves_are_split_further(asked, spoilt):
    claims(spoilt)["foot-clears"]["tree"] = "-"
    assert holds(asked(spoilt))


def leaner(table):
    constant(table, "policy.network.biases[2]", lambda bias: bias + 1.0)


def lower_fence(table):
    constant(table, "tube.lower", lambda series: series * 1.01)


def heavier(table):
    torso = table["model"]["robot"]["torso"]
    torso["mass"] = (2.0 * float.fromhex(torso["mass"])).hex()


def stricter(table):
    table["model"]["conditions"]["foot-ceiling"]["quantity"]["bound"] = 0.05


def more(table):
    for statement in table["statements"]:
        statement["bounds"] = {name: 1.3 * b + 0.01 for name, b in statement["bounds"].items()}


FALSE = [leaner, lower_fence, heavier, stricter, more]


@pytest.mark.parametrize("change", FALSE, ids=lambda change: change.__name__)
def test_false_statements_are_refuted_with_a_point(asked, spoilt, change):
    change(spoilt)
    answer = asked(hashed(spoilt))
    assert answer.returncode == 1
    assert "rejected" in answer.stdout and " at phase " in answer.stdout


def no_width(table):
    table["statements"][0]["tree"] = "1" * 60 + "-" * 61


INCONSISTENT = {
    "weights": lambda t: constant(t, "policy.cubic", lambda c: np.nextafter(c, 9.0)),
    "hash": lambda t: t.__setitem__("program_hash", t["program_hash"][::-1]),
    "operation": lambda t: t["program"]["operations"][3].__setitem__(0, "neg"),
    "tree cut": lambda t: t["statements"][0].__setitem__("tree", t["statements"][0]["tree"][:-1]),
    "tree grown": lambda t: t["statements"][1].__setitem__(
        "tree", t["statements"][1]["tree"] + "-"
    ),
    "no such axis": lambda t: t["statements"][0].__setitem__("tree", "2--"),
    "tree too deep": no_width,
    "scale": lambda t: claims(t)["foot-ceiling"]["scales"].__setitem__("foot-ceiling", 1.0),
    "region": lambda t: claims(t)["foot-rises"].__setitem__("region", "tube"),
    "root": lambda t: claims(t)["foot-rises"]["root"].__setitem__("low", ["0x1p-4", "0x0p0"]),
    "spec": lambda t: t["model"]["conditions"].__setitem__(
        "lean", dict(t["model"]["conditions"]["knee"])
    ),
    "condition that is gone": lambda t: t["model"]["conditions"].pop("knee"),
    "no such constant": lambda t: t["model"]["policy"]["arrays"].__setitem__(
        "cubic", {"constant": "policy.lower"}
    ),
    "other numbers": lambda t: t["model"]["tube"].__setitem__(
        "lower", {"shape": [7], "values": [x.hex() for x in np.linspace(1.0, 0.1, 7).tolist()]}
    ),
}


@pytest.mark.parametrize("name", INCONSISTENT)
def test_inconsistent_files_are_rejected(asked, spoilt, name):
    INCONSISTENT[name](spoilt)
    answer = asked(spoilt)
    assert answer.returncode == 1, answer.stdout
    assert answer.stdout.splitlines()[-1].startswith("rejected: ")


def quantity(table, change):
    table["model"]["conditions"]["knee"] |= change


NOT_KNOWN = {
    "function": lambda t: quantity(t, {"quantity": {"user": "mine.bend"}}),
    "inner function": lambda t: quantity(
        t, {"quantity": {"function": "at_least", "of": {"user": "bend"}, "bound": 0.1}}
    ),
    "kind": lambda t: t["model"]["conditions"].__setitem__(
        "knee", {"user": "Mine", "region": "tube", "scale": 0.5, "strength": 3}
    ),
    "policy": lambda t: t.__setitem__("model", None),
}


@pytest.mark.parametrize("name", NOT_KNOWN)
def test_what_is_not_known_is_undecided(asked, spoilt, name):
    NOT_KNOWN[name](spoilt)
    answer = asked(spoilt)
    assert answer.returncode == 3, answer.stdout
    assert answer.stdout.splitlines()[-1].startswith("undecided: ")


def test_conditions_without_a_statement_are_named(asked, spoilt):
    spoilt["statements"] = [claims(spoilt)["foot-rises"]]
    answer = asked(spoilt)
    assert answer.returncode == 3 and holds(answer)
    left = [x for x in answer.stdout.splitlines() if x.startswith("no statement about")]
    assert len(left) == 26
    assert any("torso-lower for phase in [0, 1]" in x for x in left)
    assert not any("foot-rises" in x for x in left)


def test_every_number_of_the_robot_is_printed(asked, spoilt):
    """With one changed, whatever it is: a reader must be able to see it."""
    robot = spoilt["model"]["robot"]
    places = [(robot, name) for name in ("gravity", "friction", "foot_radius")]
    for part in (*robot["leg"], robot["torso"]):
        places += [(part, name) for name in part]
    for number, (part, name) in enumerate(places):
        value = 7.25 + number / 1024
        part[name] = (value if name != "lower" else -value).hex()
    lines = [x for x in asked(spoilt).stdout.splitlines() if x.startswith("  ")]
    for number, (_, name) in enumerate(places):
        assert any(f"{7.25 + number / 1024:.17g}" in line for line in lines), name
    robot["friction"] = "banana"
    refused = asked(spoilt)
    assert refused.returncode == 2 and "'banana' instead of" in refused.stderr


UNREADABLE = {
    "empty": lambda t: "",
    "list": lambda t: "[]",
    "deep": lambda t: "[" * 100_000,
    "cut": lambda t: json.dumps(t)[:-2],
    "more": lambda t: json.dumps(t) + "{}",
    "twice": lambda t: '{"format": 3, ' + json.dumps(t)[1:],
    "NaN": lambda t: json.dumps(t).replace('"degree": 2', '"degree": NaN', 1),
    "infinity": lambda t: json.dumps(t).replace('"degree": 2', '"degree": 1e999', 1),
    "format": lambda t: t | {"format": 2},
    "fraction": lambda t: t | {"format": 3.0},
    "kind": lambda t: t | {"kind": "other"},
    "chart": lambda t: t | {"chart": "u = (phase, level)"},
    "no chart": lambda t: t | {"chart": []},
    "one axis": lambda t: t | {"chart": t["chart"][:1]},
    "axes exchanged": lambda t: t | {"chart": t["chart"][::-1]},
    "axis without a width": lambda t: (
        t | {"chart": [*t["chart"], {"name": "speed", "low": "0x1p0", "high": "0x1p0"}]}
    ),
    "axis twice": lambda t: t | {"chart": [*t["chart"], t["chart"][1]]},
    "wider phase": lambda t: t | {"chart": [t["chart"][0] | {"high": "0x1.8p0"}, t["chart"][1]]},
    "tree of bits": lambda t: (
        t | {"statements": [t["statements"][0] | {"tree": "g--"}, *t["statements"][1:]]}
    ),
    "field": lambda t: t | {"note": "trust me"},
    "no spec": lambda t: {name: value for name, value in t.items() if name != "spec"},
    "no statements": lambda t: t | {"statements": []},
    "model": lambda t: t | {"model": {}},
    "robot": lambda t: t | {"model": t["model"] | {"robot": {"leg": []}}},
    "root": lambda t: (
        t
        | {
            "statements": [
                t["statements"][0]
                | {"root": {"low": ["0x0p0", "0x0p0"], "high": ["0x1p1", "0x1p0"]}}
            ]
        }
    ),
    "decimals": lambda t: (
        t | {"statements": [t["statements"][0] | {"root": {"low": [0.0, 0.0], "high": [1.0, 1.0]}}]}
    ),
    "54 bits": lambda t: json.dumps(t).replace('"0x1.0000000000000p+0"', '"0x1.00000000000001p+0"'),
}


@pytest.mark.parametrize("name", UNREADABLE)
def test_other_files_are_refused_in_one_line(asked, spoilt, name):
    answer = asked(UNREADABLE[name](spoilt))
    assert answer.returncode == 2, answer.stdout
    assert answer.stdout == "" and answer.stderr.count("\n") == 1
    assert "expected a proof file of format 3, found in" in answer.stderr


def test_no_file_at_all(proofcheck, tmp_path):
    for arguments in ([tmp_path / "none.json"], [tmp_path], [], ["a", "b"]):
        answer = proofcheck(*arguments)
        assert answer.returncode == 2
        assert answer.stderr.startswith("expected ") and answer.stderr.count("\n") == 1
