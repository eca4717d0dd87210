"""The main loop of examples/firmware on this machine walks as the link and the package do."""

import struct
import subprocess
import time
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.control.safeguard import Fault
from neuralgaits.errors import InputError
from neuralgaits.export import build, output_folder
from neuralgaits.export.reference import Reference
from neuralgaits.export.selftest import selftest_file
from neuralgaits.export.source import gait_files
from neuralgaits.simulation.linked.config import LinkConfig
from neuralgaits.simulation.linked.connect import SOURCES
from neuralgaits.simulation.linked.remote import Remote
from neuralgaits.simulation.linked.wire import ControllerLink
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup import plant
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.sensing import sensed
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.walk import walk
from neuralgaits.workflows import demo
from neuralgaits.workflows.export import design_of
from support.designs import LAWS
from support.listening import listening

FIRMWARE = Path(__file__).parents[2] / "examples" / "firmware"
STEPS, TICKS = 3, 1000
SENSING = {"perfect": "perfect", "encoders": "encoders,bits=32,pitch_noise=0,delay_ms=0"}


def make(target: str, folder: Path, out: Path, *more: str) -> subprocess.CompletedProcess[str]:
    command = ["make", "-C", str(FIRMWARE), target, f"EXPORT={folder}", f"BUILD={out}", *more]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.fixture(scope="module")
def exported(trained, tmp_path_factory):
    """An export whose torques change as fast as a simulation's, which has no such limit."""
    design = design_of(trained)
    design = replace(design, safeguard=replace(design.safeguard, torque_swing_s=1e-12))
    files = output_folder.shipped() | gait_files(design)
    files["gait_selftest.h"] = selftest_file(design, Reference(design))
    folder = tmp_path_factory.mktemp("firmware")
    for name, text in files.items():
        (folder / name).write_text(text)
    return folder


@pytest.fixture(scope="module")
def link(exported):
    return build.build("gcc", exported, "link", SOURCES, build.PLAIN)


def walked(trained, sensing: str, address: str | None, steps: int = STEPS):
    """A walk from the centre: in compiled code in this process, or by whoever listens there."""
    setting = {
        "steps": steps,
        "z2_range": momentum_range(trained.gait),
        "record": True,
        "disturbance": sensed(PlantChanges(), SENSING[sensing]),
    }
    start = full_states(trained.zero_dynamics, trained.gait, "centre", seed=0, episodes=1)
    policy = trained.gait.policy
    if address is None:
        library = engine_of_trained(trained, "native").library
        done = walk(trained.robot, policy, start, library=library, **setting).episodes
    else:
        config = LinkConfig(lockstep=True, address=address)
        with Remote(None, list(LAWS), config, 1, 0) as remote:
            done = walk(trained.robot, policy, start, remote=remote, **setting).episodes
    assert done.record is not None
    return done.endings, done.record.result


@pytest.mark.slow
@pytest.mark.parametrize("sensing", SENSING)
def test_all_give_the_same_torques(trained, exported, link, tmp_path, sensing):
    estimate = f"HOST=-DESTIMATE={int(sensing == 'encoders')}"
    done = make("host", exported, tmp_path, estimate)
    assert done.returncode == 0, done.stderr
    inside = walked(trained, sensing, None)
    with listening(tmp_path / "firmware-host") as (_, address):
        firmware = walked(trained, sensing, address)
    with listening(link) as (_, address):
        linked = walked(trained, sensing, address)
    endings, expected = inside
    assert len(expected.leg) > TICKS and np.ptp(expected.torque[:TICKS]) > 10.0
    for there, found in (firmware, linked):
        assert there == endings
        np.testing.assert_array_equal(found.leg[:TICKS], expected.leg[:TICKS])
        for name in ("torque", "y_d", "z"):
            theirs, ours = (getattr(command, name)[:TICKS] for command in (found, expected))
            np.testing.assert_allclose(theirs, ours, rtol=0.0, atol=1e-9)


@pytest.fixture(scope="module")
def family():
    """The shipped gait with a speed command, at a speed in its range."""
    return open_run(demo.TOLD).at(speed=0.7)


@pytest.fixture(scope="module")
def commanded(tmp_path_factory):
    """The main loop and the link of a gait that takes commands, without a self-test."""
    files = output_folder.shipped() | gait_files(design_of(open_run(demo.TOLD)))
    files |= output_folder.adaptation()
    files |= {path.name: path.read_text() for path in FIRMWARE.glob("*.[ch]")}
    files["no_selftest.c"] = "int ng_selftest(void);\nint ng_selftest(void) { return 0; }\n"
    folder = tmp_path_factory.mktemp("commanded")
    for name, text in files.items():
        (folder / name).write_text(text)
    firmware = (*build.CORE, "supervisor.c", "main.c", "board_link.c", "no_selftest.c")
    programs = (
        ("firmware", firmware, ()),
        ("adapted", (*firmware, "adapt.c"), ("-DADAPT=1",)),
        ("link", SOURCES, ()),
    )
    with ExitStack() as stack:
        addresses = {}
        for name, sources, more in programs:
            program = build.build("gcc", folder, name, sources, ("-O1", "-DESTIMATE=0", *more))
            _, addresses[name] = stack.enter_context(listening(program))
        yield addresses


def numbered(sequence: int, numbers) -> bytes:
    head = struct.pack("<4sIII", b"NGR1", sequence, 1000 * sequence, 0)
    return head + np.asarray(numbers, dtype="<f8").tobytes()


def in_mid_step(family):
    """The numbers of a reading, but for the wish, of a robot in the middle of a step on leg 1."""
    state = family.zero_dynamics.phi_inv(family.gait.z(np.array([0.5, 0.5])))
    at = plant.build(family.robot).state_map
    coordinates, rates = np.split(np.asarray(state), 2)
    q, dq = at.to_mjcf(coordinates, rates, 1)
    root = [q[at.root[2]], dq[at.root[2]], *dq[at.root[:2]]]
    return [*root, 0.0, 200.0, *q[at.joints].reshape(-1), *dq[at.joints].reshape(-1)]


def of_walk(first, count: int):
    """Readings of a robot that steps about, with wishes inside and outside of their range."""
    rng = np.random.default_rng(7)
    yield numbered(2, [*first, 0.7])
    for sequence in range(3, count):
        loaded = np.roll([200.0, 0.0], sequence // 150)
        joints = rng.uniform(-0.1, 0.7, 4)
        speed = rng.uniform(0.5, 1.0)
        yield numbered(sequence, [0.0, 0.0, 0.6, 0.0, *loaded, *joints, *[0.0] * 4, speed])


def exchanged(address: str, packets) -> list[bytes]:
    """Answers but for the time of the tick, of an episode at 0.7 m/s on leg 1."""
    host, port = address.split(":")
    answers = []
    with ControllerLink.to(host, int(port)) as link:
        link.start(1, 0, 1, 0.2, 30.0, [0.7])
        for packet in packets:
            link.write(packet)
            (answer,) = link.read(time.monotonic() + 60.0)
            answers.append(answer[:-8])
    return answers


def test_the_board_speaks_the_link_s_datagrams(commanded, family):
    """Bit for bit: commands, touchdowns, late readings, and a second episode."""
    steps = list(of_walk(in_mid_step(family), 700))
    packets = [*steps, steps[-3]]
    expected = exchanged(commanded["link"], packets)
    flags = np.array([struct.unpack_from("<I", answer, 8)[0] for answer in expected])
    assert np.sum(flags & 2) > 2 and flags[-1] & 8
    for _ in range(2):
        assert exchanged(commanded["firmware"], packets) == expected


def test_a_board_that_adapts_changes_commands_after_the_first_measured_step(commanded, family):
    """The second touchdown measures a step, and the third latches what follows from it."""
    packets = list(of_walk(in_mid_step(family), 700))
    told, adapted = (exchanged(commanded[name], packets) for name in ("link", "adapted"))
    flags = np.array([struct.unpack_from("<I", answer, 8)[0] for answer in told])
    third = np.flatnonzero(flags & 2)[2]
    assert adapted[:third] == told[:third]
    assert adapted[third] != told[third]


def test_after_a_fault_the_board_damps(commanded, family):
    """Where the link's torques are zero."""
    first = in_mid_step(family)
    moving = [*first[:-4], *[1.0] * 4, 0.7]
    packets = [numbered(2, [*first, 0.7]), numbered(3, [np.nan] * 15), numbered(4, moving)]
    *_, last = exchanged(commanded["firmware"], [*packets, *(numbered(n, moving) for n in (5, 6))])
    assert struct.unpack_from("<I", last, 12)[0] == Fault.NOT_FINITE
    torque = np.frombuffer(last, "<f8", offset=16)[4:8]
    np.testing.assert_array_equal(torque, -30.0)


def refused(address: str, law: int, first: list[float]) -> str:
    """The line with which a start is refused."""
    host, port = address.split(":")
    with ControllerLink.to(host, int(port)) as link:
        with pytest.raises(InputError) as error:
            link.start(4, law, 0, 0.0, 0.0, first, list(LAWS))
        # The next one may begin.
        assert link.start(5, 0, 0, 0.0, 0.0, [0.7]).leg_joints == 2
    return str(error.value).replace(address, "there")


@pytest.mark.parametrize("kind", ["firmware", "link"])
def test_a_start_of_another_gait_is_refused_with_the_reason(commanded, kind):
    assert refused(commanded[kind], 0, []) == (
        "expected started from the controller at there, found that its gait takes 1 commands, and "
        "this one 0: start the controller of this run"
    )


def test_a_law_that_the_firmware_does_not_have_is_named(commanded):
    assert refused(commanded["firmware"], 1, [0.7]) == (
        "expected started from the controller at there, found that it has law pd and not fblin: "
        "add law=pd to --link"
    )
    assert "it has law pd and not number 9" in refused(commanded["link"], 9, [0.7])
