"""Logs in MCAP: the same walks as in CSV, and files that are none, damaged or of something else."""

import importlib.util
import json
from dataclasses import fields

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.errors import InputError
from neuralgaits.logs.formats import mcap_reader
from neuralgaits.logs.formats.column_file import read_columns
from neuralgaits.logs.formats.mcap_reader import opened
from neuralgaits.logs.formats.mcap_walk import SCHEMA, TOPIC
from neuralgaits.logs.formats.message_fields import Stamp, fields_of
from neuralgaits.workflows.simulate import simulate
from support import mcap_files, own_columns, pages
from support.mcap_files import COLUMNS, robot_messages, write_json, write_ros2
from support.shipped_run import SHIPPED

ROWS = 2000


@pytest.fixture(scope="module")
def short(log):
    """The first steps of the walk."""
    return log.only(np.arange(len(log)) < ROWS)


@pytest.fixture(scope="module")
def walk(short, tmp_path_factory):
    """A log in both formats."""
    folder = tmp_path_factory.mktemp("mcap")
    for name in ("walk.csv", "walk.mcap"):
        logs.write(folder / name, short)
    return folder


@pytest.fixture(scope="module")
def own(amber, short):
    """Columns of a robot's own log."""
    return own_columns.values(amber, short)


@pytest.fixture(scope="module")
def named(own, tmp_path_factory):
    """A robot's own log as CSV, and the files of columns of it and of its messages."""
    folder = tmp_path_factory.mktemp("own")
    own_columns.write(folder / "own.csv", own)
    (folder / "csv.toml").write_text(own_columns.SHORT)
    (folder / "mcap.toml").write_text(COLUMNS)
    return folder


def same(one, other, atol=0.0):
    for field in fields(one):
        value = getattr(one, field.name)
        if isinstance(value, np.ndarray) and field.name != "rows":
            np.testing.assert_allclose(value, getattr(other, field.name), rtol=0.0, atol=atol)


def windows_of(path, robot):
    (log,), _ = logs.read_all([path], robot)
    return logs.windows(logs.cut([log], robot).strides, samples=3, step=0.01)


def test_a_walk_is_the_same_in_both_formats(walk, amber):
    one, other = (logs.read(walk / name, amber) for name in ("walk.csv", "walk.mcap"))
    assert one.left_out == other.left_out and len(one.log) > 1000
    same(one.log, other.log)
    for mine, theirs in zip(
        windows_of(walk / "walk.csv", amber), windows_of(walk / "walk.mcap", amber), strict=True
    ):
        np.testing.assert_array_equal(mine, theirs)


def test_other_tools_find_times_units_and_fields(walk, short):
    with opened(walk / "walk.mcap") as file:
        (channel,) = file.channels.values()
        messages = list(file.messages({TOPIC}))
    assert (channel.topic, channel.encoding, channel.schema[0]) == (TOPIC, "json", SCHEMA)
    knee = json.loads(channel.schema[1])["properties"]["q"]["properties"]["stance_knee"]
    assert knee["unit"] == "rad"
    assert [one.log_time_ns for one in messages] == [round(1e9 * t) for t in short.t]
    assert messages[7].content["q"]["stance_knee"] == short.q[7, 1]


def test_the_same_log_gives_the_same_bytes(walk, short, tmp_path):
    logs.write(tmp_path / "again.mcap", short)
    assert (tmp_path / "again.mcap").read_bytes() == (walk / "walk.mcap").read_bytes()


@pytest.mark.slow
def test_simulate_writes_it(shipped_walk, tmp_path, amber):
    file = tmp_path / "walk.mcap"
    simulate(shipped_walk / "run", steps=3, episodes=2, start="region", log=file)
    assert sorted(one.name for one in tmp_path.iterdir()) == ["walk-1.mcap", "walk.mcap"]
    assert len(logs.read(file, amber).log) > 500


@pytest.mark.parametrize("write", [write_json, write_ros2])
def test_a_robot_s_own_topics_are_read_as_its_columns(write, named, own, amber, zd, tmp_path):
    path = write(tmp_path / "own.mcap", robot_messages(own))
    policy = zd.policy
    found = logs.read(path, amber, columns=named / "mcap.toml", policy=policy)
    expected = logs.read(named / "own.csv", amber, columns=named / "csv.toml", policy=policy)
    assert found.left_out == expected.left_out
    np.testing.assert_allclose(found.log.t, expected.log.t, rtol=0.0, atol=2e-9)
    for name in ("q", "pitch"):
        mine, theirs = getattr(found.log, name), getattr(expected.log, name)
        np.testing.assert_allclose(mine, theirs, rtol=0.0, atol=1e-12)
    # Times that differ in rounding put a row more or less into the parabola of a rate.
    gaps = np.abs(found.log.dq - expected.log.dq)
    assert np.quantile(gaps, 0.95) < 1e-9 and np.max(gaps) < 0.1
    np.testing.assert_array_equal(found.log.stance, expected.log.stance)


def test_the_page_s_file_of_columns_is_one(amber, tmp_path):
    page = pages.ROOT / "docs" / "mcap.md"
    (block,) = pages.blocks(page, "toml")
    (tmp_path / "columns.toml").write_text(block.text)
    columns = read_columns(tmp_path / "columns.toml", amber).columns
    (tmp_path / "short.toml").write_text(COLUMNS)
    assert columns == read_columns(tmp_path / "short.toml", amber).columns


def test_joints_are_found_by_name_in_any_order(named, own, amber, zd, tmp_path):
    order = ("knee_r", "hip_l", "knee_l", "hip_r")
    one, other = (
        logs.read(
            write_json(tmp_path / f"{k}.mcap", robot_messages(own, names)),
            amber,
            columns=named / "mcap.toml",
            policy=zd.policy,
        ).log
        for k, names in enumerate((mcap_files.JOINTS, order))
    )
    same(one, other)


def test_topics_that_are_late_or_stop_leave_rows_out(named, own, amber, zd, tmp_path):
    messages = robot_messages(own)
    begin, half = messages[0][1], messages[len(messages) // 2][1]
    kept = [
        one
        for one in messages
        if one[0] != "/imu" or (one[1] > begin + 10**8 and not half < one[1] < half + 2 * 10**8)
    ]
    path = write_json(tmp_path / "own.mcap", kept)
    found = logs.read(path, amber, columns=named / "mcap.toml", policy=zd.policy)
    assert 145 <= found.left_out["missing"] <= 155
    assert 99 <= found.log.rows[0] <= 105


@pytest.mark.parametrize(
    "settings", [{"use_chunking": False}, {"index_types": 0}, {"chunk_size": 4096}]
)
def test_files_without_an_index_are_read_too(settings, named, own, amber, zd, tmp_path):
    from mcap.writer import IndexType

    if "index_types" in settings:
        settings = {"index_types": IndexType.NONE, "use_statistics": False}
        settings |= {"repeat_channels": False, "repeat_schemas": False}
    path = write_json(tmp_path / "own.mcap", robot_messages(own), **settings)
    assert len(logs.read(path, amber, columns=named / "mcap.toml", policy=zd.policy).log) > 1000


@pytest.mark.parametrize("silent", [0, 3])
def test_many_topics_are_listed_in_one_pass(silent, tmp_path, monkeypatch):
    """A pass for each topic takes a time that grows with their square."""
    from mcap.stream_reader import breakup_chunk

    passes = []

    def counted(chunk, **settings):
        passes.append(chunk)
        return breakup_chunk(chunk, **settings)

    monkeypatch.setattr("mcap.reader.breakup_chunk", counted)
    topics = [f"/t{k:03}" for k in range(60)]
    # One topic comes late, and some channels hold nothing.
    messages = [(topic, k, {"x": k}) for k in range(3) for topic in topics[1:]]
    messages.append((topics[0], 9, {"x": 7}))
    out = write_json(tmp_path / "many.mcap", messages, unused=[f"/none{k}" for k in range(silent)])
    with opened(out) as file:
        found = file.first_messages()
    assert list(found) == topics and found[topics[0]].content == {"x": 7}
    assert len(passes) == 1


def test_fields_of_a_message():
    message = {
        "header": {"stamp": {"sec": 3, "nanosec": 7}},
        "name": ["a", "b"],
        "position": [0.5, 1],
        "more": [1.0, 2.0, 3.0],
        "on": True,
        "word": "x",
        "none": None,
        "long": [0.0] * 1000,
        "turn": {"x": 0.0, "y": 0.0998334166468, "z": 0.0, "w": 0.995004165278},
    }
    found = fields_of(message)
    assert found["header.stamp"] == Stamp(3_000_000_007)
    assert found["position[b]"] == 1 and found["more[2]"] == 3.0 and found["on"] == 1
    assert found["turn.pitch"] == pytest.approx(0.2)
    assert not {"word", "none", "long[0]"} & set(found)


def refused(path, robot, **settings):
    with pytest.raises(InputError) as error:
        logs.read(path, robot, **settings)
    message = str(error.value)
    assert message.startswith(f"log {path}") and "\n" not in message
    return message.removeprefix(f"log {path}")


def test_a_file_that_is_cut_is_refused(walk, amber, tmp_path):
    data = (walk / "walk.mcap").read_bytes()
    path = tmp_path / "cut.mcap"
    for size in np.linspace(0, len(data) - 1, 25).astype(int):
        path.write_bytes(data[:size])
        expected = "a whole MCAP file" if size >= 8 else "an MCAP file, whose first bytes"
        assert expected in refused(path, amber)


def test_a_file_with_changed_bytes_is_refused_or_read(walk, amber, tmp_path):
    data = bytearray((walk / "walk.mcap").read_bytes())
    path = tmp_path / "changed.mcap"
    rng = np.random.default_rng(0)
    outcomes = set()
    for place in rng.integers(8, len(data), 30):
        changed = data.copy()
        changed[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(changed)
        try:
            logs.read(path, amber)
        except InputError as error:
            outcomes.add("refused")
            assert "\n" not in str(error)
        else:
            outcomes.add("read")
    assert "refused" in outcomes


@pytest.mark.parametrize(
    ("messages", "expected"),
    [
        ([], "expected a channel of neuralgaits.Walk, as .* found topics none that can be read"),
        ([("/a", 1, {"x": 1.0})], "found topics /a: say with --columns FILE"),
    ],
)
def test_a_file_without_a_walk_is_refused(messages, expected, amber, tmp_path):
    import re

    path = write_json(tmp_path / "other.mcap", messages)
    assert re.search(expected, refused(path, amber))


def test_a_csv_with_another_name_is_refused(walk, amber, tmp_path):
    path = tmp_path / "walk.mcap"
    path.write_bytes((walk / "walk.csv").read_bytes())
    assert "found b't[s],s': name a log in MCAP, or end the name" in refused(path, amber)
    # And an MCAP file is read whatever its name.
    path = tmp_path / "walk.log"
    path.write_bytes((walk / "walk.mcap").read_bytes())
    assert len(logs.read(path, amber).log) > 1000


def edited_walk(walk, path, edit, unit="rad"):
    """The walk with a change in each message, and another unit of angles."""
    from mcap.writer import Writer

    with opened(walk / "walk.mcap") as file:
        (channel,) = file.channels.values()
        messages = list(file.messages({TOPIC}))
    with path.open("wb") as out:
        writer = Writer(out)
        writer.start()
        schema = channel.schema[1].replace('"unit": "rad"', f'"unit": "{unit}"')
        number = writer.register_schema(SCHEMA, "jsonschema", schema.encode())
        place = writer.register_channel(TOPIC, "json", number)
        for k, one in enumerate(messages):
            data = json.dumps(edit(k, one.content)).encode()
            writer.add_message(place, one.log_time_ns, data, one.log_time_ns)
        writer.finish()
    return path


def test_other_units_gaps_and_times_are_refused(walk, amber, tmp_path):
    path = edited_walk(walk, tmp_path / "deg.mcap", lambda k, one: one, unit="deg")
    assert refused(path, amber).startswith(
        ", its schema, column q_stance_shin[deg]: expected unit rad, found deg"
    )
    path = edited_walk(
        walk, tmp_path / "gap.mcap", lambda k, one: one | ({"z1": None} if k == 5 else {})
    )
    assert ", row 6, column z1[m]: expected a finite number, found ''" in refused(path, amber)
    path = edited_walk(
        walk,
        tmp_path / "nan.mcap",
        lambda k, one: one | ({"pitch": float("nan")} if k == 5 else {}),
    )
    assert "row 6, column pitch[rad]: expected a finite number, found 'nan'" in refused(path, amber)
    path = edited_walk(
        walk, tmp_path / "back.mcap", lambda k, one: one | ({"t": 0.001} if k == 9 else {})
    )
    assert "row 10, column t[s]" in refused(path, amber)


def test_missing_topics_and_fields_are_named(named, own, amber, zd, tmp_path):
    settings = {"columns": named / "mcap.toml", "policy": zd.policy}
    messages = [one for one in robot_messages(own) if one[0] != "/feet"]
    path = write_json(tmp_path / "feet.mcap", messages)
    assert refused(path, amber, **settings).startswith(
        ", its messages: expected the columns /feet.data[0], /feet.data[1] that"
    )
    order = ("hip_l", "Knee_L", "hip_r", "knee_r")
    renamed = own | {"Knee_L": own["knee_l"]}
    path = write_json(tmp_path / "knee.mcap", robot_messages(renamed, order))
    message = refused(path, amber, **settings)
    known = "/joint_states.position"
    assert f"write '{known}[Knee_L]' for '{known}[knee_l]'" in message
    path = write_json(tmp_path / "none.mcap", [])
    assert "expected messages in JSON or ROS 2's CDR, found no channel" in refused(
        path, amber, **settings
    )


def test_stamps_that_go_back_are_refused(named, own, amber, zd, tmp_path):
    messages = robot_messages(own)
    for topic, _, content in messages[300:330]:
        if topic == "/joint_states":
            content["header"]["stamp"]["sec"] -= 1
    path = write_json(tmp_path / "back.mcap", messages)
    message = refused(path, amber, columns=named / "mcap.toml", policy=zd.policy)
    assert "column /joint_states.header.stamp" in message


def test_without_the_extra_the_command_is_named(walk, amber, tmp_path, monkeypatch, short):
    found = importlib.util.find_spec
    monkeypatch.setattr(
        mcap_reader.importlib.util,
        "find_spec",
        lambda name: None if name == "mcap" else found(name),
    )
    expected = ": expected the package mcap for an MCAP file, found none: pip install "
    assert refused(walk / "walk.mcap", amber) == f"{expected}'neuralgaits[mcap]'"
    with pytest.raises(InputError, match=r"pip install 'neuralgaits\[mcap\]'"):
        logs.write(tmp_path / "walk.mcap", short)
    with pytest.raises(InputError, match=r"pip install 'neuralgaits\[mcap\]'"):
        simulate(SHIPPED, steps=1, log=tmp_path / "walk.mcap")
    assert list(tmp_path.iterdir()) == []
