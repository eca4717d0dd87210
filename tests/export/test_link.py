"""A walk through a process boundary, in lock-step: no clock, so the same walk every time."""

import shutil
import socket
import struct
import subprocess
from threading import Thread

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError
from neuralgaits.export import build, output_folder
from neuralgaits.export.source import gait_files
from neuralgaits.simulation.linked import wire
from neuralgaits.simulation.linked.channel import Channel
from neuralgaits.simulation.linked.config import LinkConfig, parse_link
from neuralgaits.simulation.linked.connect import SOURCES
from neuralgaits.simulation.linked.remote import Remote
from neuralgaits.simulation.linked.wire import ControllerLink
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.walk import walk
from neuralgaits.workflows import demo
from neuralgaits.workflows.export import design_of
from neuralgaits.workflows.simulate import simulate
from support.designs import LAWS
from support.listening import listening

STEPS = 4


@pytest.fixture(scope="module")
def program(trained, tmp_path_factory):
    folder = tmp_path_factory.mktemp("link")
    for name, text in (output_folder.shipped() | gait_files(design_of(trained))).items():
        (folder / name).write_text(text)
    return build.build("gcc", folder, "controller", SOURCES, build.PLAIN)


def walked(trained, program, config, controller="pd", record=True, watch=None):
    """A walk from the centre, through a process if there are settings of its link."""
    setting = {
        "controller": controller,
        "steps": STEPS,
        "z2_range": momentum_range(trained.gait),
        "record": record,
        "watch": watch,
    }
    start = full_states(trained.zero_dynamics, trained.gait, "centre", seed=0, episodes=1)
    if config is None:
        return walk(trained.robot, trained.gait.policy, start, **setting), None
    with Remote(program, list(LAWS), config, 1, 0) as remote:
        done = walk(trained.robot, trained.gait.policy, start, remote=remote, **setting)
    return done, remote.summary()


@pytest.fixture(scope="module")
def both(trained, program, tmp_path_factory):
    """The same walk in Python and through the process, with the process's own log."""
    log = tmp_path_factory.mktemp("log") / "robot.csv"
    config = LinkConfig(law="fblin", lockstep=True, log=str(log))
    inside, _ = walked(trained, None, None, controller="fblin")
    outside, summary = walked(trained, program, config, controller="fblin")
    return inside.episodes, outside.episodes, summary, log


def test_the_process_walks_as_python_does(both):
    inside, outside, summary, _ = both
    assert outside.endings == inside.endings
    assert summary["deadline_misses"] == 0 and summary["faults"] == [0]
    found, expected = outside.record.result, inside.record.result
    # From rest, the first torques are held back by their rate limit: the walks differ by that.
    size = min(len(found.leg), len(expected.leg))
    assert abs(len(found.leg) - len(expected.leg)) <= 3
    steady = slice(5, size // 2)
    apart = np.abs(found.torque[steady] - expected.torque[steady])
    assert np.median(apart) < 0.05 and np.median(np.abs(expected.torque[steady])) > 1.0
    np.testing.assert_allclose(found.z[steady], expected.z[steady], atol=0.05)


def test_one_tick_is_python_s_to_rounding(both):
    """The first tick sees the same state: what the policy wants is equal to the last digits."""
    inside, outside, _, _ = both
    for name in ("q", "dq", "y_d", "dy_d", "z"):
        found = getattr(outside.record.result, name)[0]
        np.testing.assert_allclose(found, getattr(inside.record.result, name)[0], rtol=1e-10)


def test_the_process_writes_a_log_that_is_read(both, trained):
    """The 38 columns of the robot, in the signs and names of the package."""
    _, outside, _, path = both
    log = logs.read(path, trained.robot).log
    command = outside.record.result
    assert len(log.t) == len(command.leg)
    np.testing.assert_allclose(log.t, outside.record.time, atol=1e-9)
    np.testing.assert_array_equal(log.stance, command.leg)
    for mine, theirs in (("q", "q"), ("dq", "dq"), ("qd", "y_d"), ("dqd", "dy_d")):
        np.testing.assert_allclose(
            getattr(log, mine), getattr(command, theirs), rtol=1e-7, atol=1e-7
        )
    np.testing.assert_allclose(log.tau, command.actuated, rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(log.pitch, outside.record.pitch, rtol=1e-7, atol=1e-9)


def test_it_walks_with_lost_and_late_packets(trained, program):
    config = LinkConfig(law="fblin", lockstep=True, loss=0.01, jitter_ms=2.0)
    done, summary = walked(trained, program, config, controller="fblin", record=False)
    assert not done.episodes.endings[0].fell
    assert summary is not None
    assert summary["packets_lost"] > 0.005 * summary["packets_sent"]
    assert summary["packets_late"] > 0.5 * summary["packets_sent"]
    assert summary["deadline_misses"] > 0


@pytest.fixture
def link(program):
    with ControllerLink(program) as open_link:
        yield open_link


def reading(sequence, time_us, numbers):
    data = np.asarray(numbers, dtype="<f8").tobytes()
    return struct.pack("<4sIII", b"NGR1", sequence, time_us, 0) + data


STANDING = [0.0, 0.0, 0.6, 0.0, 200.0, 0.0, 0.3, -0.2, 0.5, 0.3, 0.0, 0.0, 0.0, 0.0]


def ask(link, packet):
    import time

    link.write(packet)
    return link.read(time.monotonic() + 0.5)


def test_the_protocol_as_the_page_has_it(link):
    """Written out in bytes, apart from the package's own client."""
    link.start(10, 0, 0, 0.0, 0.0)
    (answer,) = ask(link, reading(11, 1000, STANDING))
    head, sequence, flags, fault = struct.unpack_from("<4sIII", answer)
    assert (head, sequence, fault) == (b"NGC1", 11, 0)
    assert not flags & (1 | 2 | 8)
    assert len(answer) == 16 + 8 * (4 + 4 + 3 * 4 + 2 + 2)
    numbers = np.frombuffer(answer, "<f8", offset=16)
    assert np.all(np.abs(numbers[4:8]) <= 41.0) and np.any(numbers[4:8] != 0.0)


def test_old_readings_are_not_used(link):
    link.start(0, 0, 0, 0.0, 0.0)
    (first,) = ask(link, reading(5, 5000, STANDING))
    (again,) = ask(link, reading(4, 4000, STANDING))
    assert struct.unpack_from("<I", again, 8)[0] & 8
    assert again[16:-8] == first[16:-8]


@pytest.mark.parametrize(
    "packet",
    [
        b"",
        b"NGR1",
        b"NGXX" + bytes(200),
        reading(3, 0, STANDING)[:-1],
        reading(3, 0, [*STANDING, 0.0]),
        bytes(1400),
    ],
    ids=["empty", "short", "unknown", "cut", "long", "zeros"],
)
def test_other_datagrams_are_ignored(link, packet):
    link.start(0, 0, 0, 0.0, 0.0)
    assert ask(link, packet) == []
    assert len(ask(link, reading(7, 1000, STANDING))) == 1


@pytest.mark.parametrize(
    ("rest", "why"), [((99, 0), (1, 0)), ((0, 0, 0.7), (2, 0))], ids=["no such law", "commands"]
)
def test_a_start_that_is_not_of_this_gait_is_refused_and_changes_nothing(link, rest, why):
    link.start(0, 0, 0, 0.0, 0.0)
    law, leg, *further = rest
    packet = (
        b"NGS1" + struct.pack("<III", 8, law, leg) + np.array([0, 0, *further], "<f8").tobytes()
    )
    assert ask(link, packet) == [b"NGX1" + struct.pack("<III", 8, *why)]
    assert len(ask(link, reading(7, 1000, STANDING))) == 1


def test_bad_numbers_give_zero_torque_and_a_reason(link):
    link.start(0, 1, 0, 0.0, 0.0)
    (answer,) = ask(link, reading(1, 1000, [float("nan"), *STANDING[1:]]))
    assert struct.unpack_from("<I", answer, 12)[0] == 1
    assert not np.any(np.frombuffer(answer, "<f8", offset=16)[:8])


def test_a_plant_that_was_silent_for_too_long_is_not_driven_on(link):
    """Forty milliseconds without a reading pass; sixty are a fault that stays."""
    link.start(0, 0, 0, 0.0, 0.0)
    faults = []
    for sequence, time_us in enumerate([1000, 41_000, 101_000, 102_000], start=1):
        (answer,) = ask(link, reading(sequence, time_us, STANDING))
        faults.append(struct.unpack_from("<I", answer, 12)[0])
    assert faults == [0, 0, 7, 7]


def test_a_reading_without_rates_is_answered_from_its_estimate(link):
    """Rates of later readings are not used then: whatever they are, the answers are the same."""
    answers = []
    for rate in (0.0, 3.0):
        link.start(0, 0, 0, 0.0, 0.0)
        for sequence in (1, 2, 3):
            rates = [rate if sequence > 1 else 0.1] * 4
            packet = reading(sequence, 1000 * sequence, [*STANDING[:10], *rates])
            (answer,) = ask(link, packet[:12] + struct.pack("<I", 1) + packet[16:])
        answers.append(answer[:-8])
    assert answers[0] == answers[1]
    assert np.any(np.frombuffer(answers[0], "<f8", offset=16)[4:8] != 0.0)


def test_somebody_else_s_controller_walks_and_lives_on(trained, program):
    """As the one that is started here does, and again afterwards: nobody has ended it."""
    own, _ = walked(trained, program, LinkConfig(lockstep=True))
    assert own.episodes.record is not None
    with listening(program) as (process, address):
        config = LinkConfig(lockstep=True, address=address)
        for _ in range(2):
            other, summary = walked(trained, None, config)
            assert summary is not None and summary["address"] == address
            found, expected = other.episodes.record, own.episodes.record
            assert found is not None
            np.testing.assert_array_equal(found.result.torque, expected.result.torque)
        assert process.poll() is None


@pytest.mark.parametrize("lockstep", [True, False], ids=["lock-step", "real time"])
def test_a_controller_that_ends_is_one_line(trained, program, lockstep):
    with listening(program) as (process, address):
        ticks = []

        def watch(*_):
            ticks.append(1)
            if len(ticks) == 20:
                process.kill()
                process.wait()

        config = LinkConfig(lockstep=lockstep, address=address)
        with pytest.raises(InputError, match=rf"controller at {address} to listen, found none"):
            walked(trained, None, config, watch=watch)
        assert len(ticks) == 20


@pytest.fixture
def silent():
    """The address of a socket that never answers."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as made:
        made.bind(("127.0.0.1", 0))
        yield "{}:{}".format(*made.getsockname())


def test_a_controller_that_never_answers_is_one_line(trained, silent, monkeypatch):
    monkeypatch.setattr(wire, "_START_TIMEOUT_S", 0.01)
    config = LinkConfig(lockstep=True, address=silent)
    with pytest.raises(InputError, match=rf"started from the controller at {silent}, found sil"):
        walked(trained, None, config)


def answers_of(packets):
    """A thread's address that answers what it gets with these packets in turn."""
    server = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    server.bind(("127.0.0.1", 0))

    def serve():
        with server:
            for packet in packets:
                _, peer = server.recvfrom(2048)
                server.sendto(packet, peer)

    Thread(target=serve, daemon=True).start()
    return "{}:{}".format(*server.getsockname())


STARTED = struct.pack("<4sIII", b"NGA1", 0, 2, 4)


@pytest.mark.parametrize(
    ("packets", "message"),
    [
        ([struct.pack("<4sIII", b"NGA1", 0, 3, 6)], r"2 joints a leg and 4 .*found one of 3 and 6"),
        ([STARTED, struct.pack("<4sIII", b"NGC1", 1, 0, 0)], r"commands of 24 numbers, found 0"),
    ],
    ids=["of another robot", "of another length"],
)
def test_the_controller_of_another_run_is_one_line(trained, packets, message):
    config = LinkConfig(lockstep=True, address=answers_of(packets))
    with pytest.raises(InputError, match=message):
        walked(trained, None, config)


def test_nothing_at_the_address_leaves_the_run_as_it_is(tmp_path, capfd):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as closed:
        closed.bind(("127.0.0.1", 0))
        address = "{}:{}".format(*closed.getsockname())
    run = shutil.copytree(demo.FOLDER, tmp_path / "run")
    before = {path: path.read_bytes() for path in run.rglob("*") if path.is_file()}
    link = f"lockstep=1,address={address}"
    assert main(["simulate", str(run), "--controller", "c", "--link", link]) == 2
    *_, line = capfd.readouterr().err.splitlines()
    assert f"expected the controller at {address} to listen, found none there" in line
    assert {path: path.read_bytes() for path in run.rglob("*") if path.is_file()} == before


def test_the_channel_delays_and_loses_as_told():
    channel = Channel(0.25, 2, (1,))
    arrivals = {}
    for tick in range(20_000):
        channel.send(tick, tick)
        arrivals |= {packet: tick for packet in channel.arrived(tick)}
    delays = np.array([at - sent for sent, at in arrivals.items()])
    assert set(delays) == {0, 1, 2}
    np.testing.assert_allclose(np.bincount(delays) / len(delays), 1.0 / 3.0, atol=0.02)
    np.testing.assert_allclose(channel.lost / channel.sent, 0.25, atol=0.02)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("speed=1", r"unknown link setting 'speed'"),
        ("loss=much", r"expected a number"),
        ("loss=0.9", r"expected 0 to 0.5"),
        ("jitter_ms=0.5", r"whole milliseconds"),
        ("lockstep", r"NAME=VALUE"),
        ("lockstep=7", r"lockstep: expected 0 or 1, found 7"),
        ("lockstep=0.5", r"lockstep: expected 0 or 1"),
        ("lockstep=nan", r"lockstep: expected 0 or 1"),
        ("loss=0.1,loss=0.2", r"loss is given twice"),
        ("loss=0.1,", r"nothing before or after a comma"),
        ("address=localhost", r"address: expected HOST:PORT with a port from 1 to 65535"),
        ("address=:9000", r"address: expected HOST:PORT"),
        ("address=robot:0", r"address: expected HOST:PORT"),
        ("address=robot:65536", r"address: expected HOST:PORT"),
        ("address=robot:9000,log=walk.csv", r"log without address, found both"),
        ({"address": 9000}, r"address: expected HOST:PORT.*found 9000"),
        ({"loss": None}, r"loss: expected a number, found None"),
        ({1: 2}, r"unknown link setting 1: expected one of"),
        (0, r"link: expected NAME=VALUE,... or a mapping, found 0"),
    ],
)
def test_bad_link_settings_are_one_line(text, message):
    with pytest.raises(InputError, match=message):
        parse_link(text)


def test_refusals(trained, program):
    with pytest.raises(InputError, match=r"only, found 'loss=0.1'"):
        simulate(trained, link="loss=0.1")
    with pytest.raises(InputError, match=r"1 episode in real time"):
        Remote(program, ["pd"], LinkConfig(), 2, 0)
    elsewhere = LinkConfig(address="127.0.0.1:9000", lockstep=True)
    with pytest.raises(InputError, match=r"1 episode with --link address, found 2"):
        Remote(None, ["pd"], elsewhere, 2, 0)
    with pytest.raises(InputError, match=r"a host that can be reached, found 'no host'"):
        Remote(None, ["pd"], LinkConfig(address="no host:9000"), 1, 0)
    with pytest.raises(InputError, match=r"link law: expected one of pd, found 'lqr'"):
        Remote(program, ["pd"], LinkConfig(law="lqr"), 1, 0)


def test_the_process_refuses_bad_usage(program, tmp_path):
    done = subprocess.run([str(program), "--speed", "3"], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.startswith("usage: link")
    missing = str(tmp_path / "no" / "folder.csv")
    done = subprocess.run([str(program), "--log", missing], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.count("\n") == 1
