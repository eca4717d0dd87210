"""Files of gaits: what is read, and what is refused in one line."""

import json

import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.hzd.gait_file import read_gait, write_gait
from support import published_gaits

GAIT = published_gaits.GAITS["0.67"]
JOINTS = ["stance_knee", "stance_hip", "swing_hip", "swing_knee"]


def one(**changes):
    """A file of one gait, with some fields changed; those that are None are left out."""
    gait = {"joints": JOINTS, "bezier": GAIT["bezier"], "p": GAIT["p"]} | changes
    return {name: value for name, value in gait.items() if value is not None}


@pytest.fixture
def file(tmp_path):
    def write(content):
        path = tmp_path / "gait.json"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return path

    return write


def test_what_is_written_is_read_again(amber, file):
    gait = read_gait(published_gaits.FILE, amber, "0.67")
    np.testing.assert_array_equal(gait.coefficients, GAIT["bezier"])
    assert gait.z1_range == (GAIT["p"][1], GAIT["p"][0])
    again = read_gait(file(write_gait(amber, gait)), amber)
    np.testing.assert_array_equal(again.coefficients, gait.coefficients)
    assert again.z1_range == gait.z1_range


def test_rows_in_another_order_and_convention(amber, file):
    """A file whose hips turn the other way from another zero, rows from the swing knee upwards."""
    rows = np.array(GAIT["bezier"])
    theirs = np.stack([rows[3], 0.25 - rows[2], 0.25 - rows[1], rows[0]])
    content = one(
        joints=JOINTS[::-1],
        bezier=theirs.tolist(),
        signs=[1, -1, -1, 1],
        offsets=[0, 0.25, 0.25, 0],
    )
    np.testing.assert_allclose(read_gait(file(content), amber).coefficients, rows, atol=1e-15)


@pytest.mark.parametrize(
    ("content", "name", "message"),
    [
        (one(joints=["knee", "hip"]), None, "expected the joints of amber3m, stance_knee, .* knee"),
        (one(joints="knees"), None, "expected the joints of amber3m"),
        (one(joints=None), None, 'expected "joints", names of the actuated joints, found none'),
        (one(bezier=[[0.1, 0.2]] * 3), None, "a row for each of stance_knee, .*, found 3 rows"),
        (one(bezier=0.1), None, "a row for each of stance_knee, .*, found 0.1"),
        (one(bezier=[0.1] * 4), None, "in the row of stance_knee of .bezier., found 0.1"),
        (
            one(bezier=[[0.1, 0.2], [0.1]] * 2),
            None,
            "for stance_hip in .bezier. as for stance_knee, 2, found 1",
        ),
        (one(bezier=[[0, 1]] * 3 + [[0.1, "much"]]), None, "in the row of swing_knee of .bezier."),
        (one(bezier=[[0, 1]] * 3 + [[0.1, 1e999]]), None, "found a damaged file"),
        (one(bezier=[[0.1, float("nan")]] * 4), None, "found a damaged file .the number NaN."),
        (one(bezier=[[0.1]] * 4), None, "of degree 1 to 20, found 0"),
        (one(bezier=[[0.1] * 30] * 4), None, "of degree 1 to 20, found 29"),
        (one(p=GAIT["p"][::-1]), None, "the end further ahead"),
        (one(p=[0.1]), None, '2 finite numbers as "p"'),
        (one(signs=[1, 1]), None, '4 finite numbers as "signs", found .1, 1.'),
        (one(signs=[1, 1, -1, 57.3]), None, '"signs" of 1 or -1, found 1, 1, -1, 57.3'),
        (one(sign=[1, 1, 1, 1]), None, "found 'sign'; did you mean signs"),
        (one(offset=[0, 0, 0, 0]), None, "found 'offset'; did you mean offsets"),
        ({"gait": {"a": one()}}, None, "found 'gait'; did you mean gaits"),
        (one(), "0.67", "found one: leave --name out"),
        ({"gaits": {}}, None, 'expected "gaits" to hold gaits by name'),
        (
            {"gaits": {"a": one(), "b": one()}},
            None,
            "expected --name to be one of a, b, found none",
        ),
        ({"gaits": {"walk": one()}}, "wal", "did you mean walk"),
        ({"gaits": {"walk": 3}}, "walk", "expected an object for gait 'walk', found 3"),
        ("{", None, "expected a JSON object, found a damaged file"),
        ("[1]", None, "expected a JSON object, found list"),
    ],
)
def test_what_is_no_gait_of_the_robot_is_refused(amber, file, content, name, message):
    with pytest.raises(InputError, match=message) as refusal:
        read_gait(file(content), amber, name)
    assert "\n" not in str(refusal.value)


def test_a_file_that_is_not_there(amber, tmp_path):
    with pytest.raises(InputError, match="expected a gait file, found none at"):
        read_gait(tmp_path / "none.json", amber)
