"""Levels 2 and 3 of a trained gait: proved, checked again, and true in simulations of the model."""

import json
import shutil
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.levels.orbit.return_map import slope
from neuralgaits.certificate.levels.walking_set import margins as walking_set
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants
from neuralgaits.errors import InputError
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof
from neuralgaits.workflows.report import saved_of

PUSH = (0.01, 0.3)
"""Bound on what is added to dz: 10 mm/s and 0.3 N m."""


@pytest.fixture(scope="module")
def run(certified, tmp_path_factory):
    """The default gait, proved to level 3, in a folder of this file's own."""
    return open_run(shutil.copytree(certified.path, tmp_path_factory.mktemp("sets") / "run"))


@pytest.fixture(scope="module")
def certificate(run):
    """What `certify` says of it: all boxes are there already."""
    return certify(run, resume=True)


@pytest.fixture(scope="module")
def proof(certificate):
    return json.loads(Path(certificate.summary["proof"]).read_text())


def test_the_default_gait_walks_for_ever(certificate):
    assert certificate.verdict == "proved"
    second, third = certificate.conclusions
    assert second.figures["relative_width"] >= 0.32
    assert third.figures["contraction_at_most"] < 1.0
    assert third.figures["z2_width_at_most"] <= 1e-3
    assert 0.0 < third.figures["multiplier_at_least"] < third.figures["multiplier_at_most"] < 1.0


@pytest.mark.slow
def test_level_2_is_checked_again_in_balls(proof, run, tmp_path):
    """Every statement but those of level 3: its 2,500 boxes would take as long again."""
    short = json.loads(json.dumps(proof))
    short["theorems"][1]["claimed"] = False
    short["statements"] = [
        s for s in short["statements"] if not s["conditions"][0].startswith("orbit/")
    ]
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(short))
    result = check_proof(path, run=run.path)
    assert (result["verdict"], result["reason"]) == ("proved", None)
    assert [(level["level"], level["verdict"]) for level in result["levels"]] == [(2, "proved")]
    assert result["unclaimed"] == []


def parameters(level, name, value):
    def change(proof):
        proof["theorems"][level - 2]["parameters"][name] = value

    return change


def without(output):
    def change(proof):
        for statement in proof["statements"]:
            if output in statement["conditions"]:
                statement["conditions"].remove(output)
                statement["bounds"].pop(output)
                statement["scales"].pop(output)
        proof["statements"] = [s for s in proof["statements"] if s["conditions"]]

    return change


@pytest.mark.parametrize(
    "change",
    [
        parameters(2, "guard_strip", (1e-3).hex()),
        parameters(2, "falling", (0.9).hex()),
        parameters(2, "disturbance", [(0.1).hex(), (0.0).hex()]),
        parameters(3, "expansion", [(-0.5).hex()]),
        parameters(3, "lower", [(0.5).hex()]),
        without("set/fence-lower"),
        without("set/reset-level"),
        without("set/after torso-upper"),
        without("orbit/gain"),
    ],
)
def test_a_theorem_without_its_premises_is_rejected(proof, tmp_path, monkeypatch, change):
    # Bounding the boxes again is tested elsewhere: here the statements are taken as true.
    from neuralgaits.certificate.proof_file import shared_check as module

    monkeypatch.setattr(module, "cores", lambda: 1)
    monkeypatch.setattr(module.StatementCheck, "walk", lambda self, leaves: iter(()))
    altered = json.loads(json.dumps(proof))
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(altered))
    assert check_proof(path)["verdict"] == "consistent"
    change(altered)
    path.write_text(json.dumps(altered))
    assert check_proof(path)["verdict"] == "rejected"


@pytest.mark.slow
def test_states_of_the_set_walk_on_whatever_pushes_them(run):
    """200 starts, 6 steps, dz pushed to a corner of its bound at random: none leaves."""
    done = certify(run, level=2, disturbance=PUSH)
    assert done.verdict == "proved", done.conclusions[0].reason
    assert "0.3 N m" in done.conclusions[0].words[1]
    assert saved_of(run.folder).disturbance == PUSH
    gait, zd, steps = run.gait, run.zero_dynamics, 150
    pushed = walking_set.disturbed(zd, PUSH)

    @jax.jit
    @jax.vmap
    def stride(key, level):
        """From the start of a step to the next; levels at the start, on the way, at the end."""
        low, high = gait.tube.fences(jnp.array(0.0))
        zeta = low + level * (high - low)

        def rate(phase, zeta, corner):
            point = [d.point(gait.state(phase, zeta)) for d in pushed]
            return jnp.stack([slope(gait, p) for p in point])[corner]

        def move(carry, phase):
            key, zeta = carry
            key, draw = jax.random.split(key)
            corner, h = jax.random.randint(draw, (), 0, 4), 1.0 / steps
            k1 = rate(phase, zeta, corner)
            zeta = zeta + h * rate(phase + 0.5 * h, zeta + 0.5 * h * k1, corner)
            return (key, zeta), gait.level(gait.state(phase + h, zeta))

        phases = jnp.linspace(0.0, 1.0, steps, endpoint=False)
        (key, zeta), levels = jax.lax.scan(move, (key, zeta), phases)
        after = zd.reset(gait.state(jnp.ones_like(zeta), zeta))
        return key, gait.level(after), levels

    levels = jnp.concatenate([jnp.array([0.0, 1.0]), jnp.linspace(1e-3, 1.0 - 1e-3, 198)])
    keys = jax.random.split(jax.random.key(0), len(levels))
    widest = [0.0, 1.0]
    for _ in range(6):
        keys, levels, way = stride(keys, levels)
        assert np.all((way > -1e-6) & (way < 1.0 + 1e-6))
        assert np.all((levels > 0.0) & (levels < 1.0))
        widest_now = [float(levels.min()), float(levels.max())]
        assert widest_now[0] > widest[0] - 1e-6
        assert widest_now[1] < widest[1] + 1e-6
    assert widest_now[1] - widest_now[0] < 0.6  # The set contracts although it is pushed.


@pytest.mark.slow
def test_too_large_a_disturbance_is_undecided(run):
    done = certify(run, level=3, disturbance=(0.3, 30.0), budget=6.0)
    assert done.verdict == "undecided"
    assert "is not proved" in str(done.conclusions[0].reason)
    assert done.conclusions[1].reason == "level 2 is not proved"
    with pytest.raises(InputError, match="disturbance"):
        certify(run, disturbance=(float("nan"), 0.0))


def test_margins_of_the_set_are_its_definitions(run):
    gait, zd = run.gait, run.zero_dynamics
    shape = WalkingSetConstants(1e-3, 1e-3, 0.1, 0.9, PUSH, (), ())
    u = jnp.array([0.4, 0.3])
    found = walking_set.margins(run.spec, gait, zd, shape, u)
    point, (start, guard) = zd.point(gait.z(u)), gait.span
    assert len(found["set/forward"]) == 4
    assert np.min(found["set/forward"]) == pytest.approx(
        float((point.dz[0] - PUSH[0]) / (guard - start))
    )
    # The rate of the level along the pushed flow, at a fence, by differences.
    edge = jnp.array([0.4, 0.0])
    z = gait.z(edge)
    inward = walking_set.margins(run.spec, gait, zd, shape, edge)["set/fence-lower"]
    worst = []
    for a in (-1, 1):
        for b in (-1, 1):
            dz = zd.zdot(z) + jnp.array([a * PUSH[0], b * PUSH[1]])
            step = 1e-6
            moved = gait.level(z + step * dz) - gait.level(z - step * dz)
            worst.append(float(moved / (2 * step) / (dz[0] / (guard - start))))
    assert sorted(worst) == pytest.approx(sorted(inward.tolist()), rel=1e-6)
