"""A log that is refused for one wrong sign or zero: which one, and when nothing is said."""

import re

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.errors import InputError
from neuralgaits.workflows.fit import fit
from support import own_columns

ROWS = 2500


@pytest.fixture(scope="module")
def own(amber, log):
    return own_columns.values(amber, log.only(np.arange(len(log)) < ROWS))


@pytest.fixture
def refused(amber, zd, tmp_path):
    """The line with which columns are refused."""

    def refuse(columns, text=own_columns.SHORT, edit=lambda text: text, **settings):
        path = own_columns.write(tmp_path / "own.csv", columns)
        path.write_text(edit(path.read_text()))
        (tmp_path / "columns.toml").write_text(text)
        settings = {"policy": zd.policy, "mend": True} | settings
        with pytest.raises(InputError) as error:
            logs.read(path, amber, columns=tmp_path / "columns.toml", **settings)
        assert "\n" not in str(error.value)
        return str(error.value)

    return refuse


@pytest.mark.parametrize(("joint", "sign"), [("knee_right", -1), ("hip_right", 1)])
def test_a_turned_sign_is_named(joint, sign, own, refused):
    name = own_columns.JOINTS[joint]
    turned = 2.0 * own_columns.OFFSETS.get(name, 0.0) - own[name]
    message = refused(own | {name: turned})
    assert message.endswith(f"; joints.{joint} fits with sign = {sign}, all else as it is")


@pytest.mark.parametrize(("joint", "moved"), [("knee_left", 20.0), ("hip_right", -20.0)])
def test_a_moved_zero_is_named_with_its_size(joint, moved, own, refused):
    name = own_columns.JOINTS[joint]
    message = refused(own | {name: own[name] + moved})
    found = re.search(rf"; joints.{joint} fits with offset = (\S+), (\S+) rad (\w+), all", message)
    assert found is not None
    expected = own_columns.OFFSETS.get(name, 0.0) + moved
    assert float(found[1]) == pytest.approx(expected, abs=0.1)
    assert float(found[2]) == pytest.approx(np.deg2rad(20.0), abs=0.01)
    assert found[3] == ("higher" if moved > 0.0 else "lower")


def test_nothing_is_named_where_two_are_wrong(own, refused):
    both = {name: -own[name] for name in ("knee_l", "knee_r")}
    message = refused(own | both)
    assert "fits with" not in message and message.endswith("mend them there)")


def test_nothing_is_named_where_signs_and_zeros_are_not_at_fault(own, refused):
    assert "fits with" not in refused(own, edit=lambda text: text.replace("0.0,", "lost,", 1))
    assert "fits with" not in refused(own | {"t_ms": own["t_ms"][::-1]})
    turned = own | {"knee_r": -own["knee_r"]}
    assert "fits with" not in refused(turned, policy=None)
    assert "fits with" not in refused(turned, mend=False)


def test_fit_names_it(shipped_walk, tmp_path):
    turned = own_columns.SHORT.replace(
        '"knee_r", unit = "deg"', '"knee_r", unit = "deg", sign = -1'
    )
    (tmp_path / "columns.toml").write_text(turned)
    with pytest.raises(InputError, match=r"; joints\.knee_right fits with sign = 1, all else"):
        fit(shipped_walk / "run", [shipped_walk / "own.csv"], columns=tmp_path / "columns.toml")
