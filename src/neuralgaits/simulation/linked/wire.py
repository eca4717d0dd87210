"""Datagrams (UDP) to and from a controller in a process of its own, see docs/link.md."""

import selectors
import socket
import struct
import subprocess
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.control.measurement import Measurement
from neuralgaits.errors import InputError, reason
from neuralgaits.robots.layout import MjcfLayout

_HEAD = struct.Struct("<4sIII")
_START_TIMEOUT_S = 10.0
_OTHER_LAW, _OTHER_COMMANDS = 1, 2
"""Reasons of a controller that refuses a start: it lacks the law, or takes other commands."""
_LEG, _TOUCHDOWN, _SATURATED, _STALE = 1, 2, 4, 8


class Answer(NamedTuple):
    """A command from the controller, as decoded."""

    sequence: int
    """Number of the reading that it answers."""
    leg: int
    """Stance leg of the controller."""
    touchdown: bool
    """Whether the stance leg has just changed."""
    saturated: bool
    """Whether the law's torque was above the limits."""
    stale: bool
    """Whether a later reading had come before; nothing was computed then."""
    fault: int
    """Reason why torques are zero, `control.safeguard.Fault`; 0 for none."""
    numbers: Float[np.ndarray, " a"]
    """Further numbers: motors, torques [2 k each], actuated, y_d, dy_d [m each], z [2], commands of
    the step before and of this one [p each], time since touchdown, step us."""


def pack_reading(
    layout: MjcfLayout,
    measurement: Measurement,
    sequence: int,
    commands: Sequence[float] | Float[np.ndarray, " p"] = (),
    *,
    estimated: bool = False,
) -> bytes:
    """Return a reading's datagram, in the robot file's signs and zeros.

    Args:
        layout: layout of the plant's file.
        measurement: what the sensors measure.
        sequence: number of the reading.
        commands: commands requested from the next touchdown on.
        estimated: whether the controller has to estimate rates and velocity. Those of the
            measurement are where its estimator starts.
    """
    signs, offsets = np.array(layout.leg_joint_signs), np.array(layout.leg_joint_offsets)
    turn = float(measurement.pitch) - layout.root_angle
    dpitch = float(measurement.dpitch)
    _, arm_slope = layout.hip_arm(turn, np)
    numbers = np.concatenate(
        [
            [layout.pitch_sign * turn, layout.pitch_sign * dpitch],
            np.asarray(measurement.hip_velocity) - dpitch * arm_slope,
            measurement.normal_force,
            (signs * (np.asarray(measurement.angles) - offsets)).reshape(-1),
            (signs * np.asarray(measurement.rates)).reshape(-1),
            np.asarray(commands, dtype=np.float64),
        ]
    )
    micros = round(1e6 * float(measurement.time)) % 2**32
    # Flag of a reading whose rates and velocity are not measured.
    flags = 1 if estimated else 0
    return _HEAD.pack(b"NGR1", sequence, micros, flags) + numbers.astype("<f8").tobytes()


def sequence_of(packet: bytes) -> int:
    """Return the number of a reading."""
    return _HEAD.unpack_from(packet)[1]


def unpack_answer(packet: bytes) -> Answer | None:
    """Decode a command; return None for any other packet."""
    if len(packet) < _HEAD.size or packet[:4] != b"NGC1":
        return None
    _, sequence, flags, fault = _HEAD.unpack_from(packet)
    return Answer(
        sequence=sequence,
        leg=flags & _LEG,
        touchdown=bool(flags & _TOUCHDOWN),
        saturated=bool(flags & _SATURATED),
        stale=bool(flags & _STALE),
        fault=fault,
        numbers=np.frombuffer(packet, "<f8", offset=_HEAD.size),
    )


class Shape(NamedTuple):
    """Sizes of a controller's robot, as it states them."""

    leg_joints: int
    """Joints of a leg, its hip included."""
    actuated: int
    """Actuated coordinates."""


class ControllerLink:
    """A socket to a controller, and its process if it is one of ours. Use as a context."""

    def __init__(self, program: Path, log: Path | None = None):
        """Start the process of a controller.

        Args:
            program: program compiled from an export.
            log: file for the controller's own log.
        """
        extra = [] if log is None else ["--log", str(log)]
        process = subprocess.Popen(
            [str(program), *extra],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
        )
        assert process.stdout is not None
        words = process.stdout.readline().split()
        if len(words) != 2 or words[0] != "port":
            _, complaint = process.communicate()
            raise InputError(f"expected a controller that listens, found: {complaint.strip()}")
        self._open(("127.0.0.1", int(words[1])), process)

    @classmethod
    def to(cls, host: str, port: int) -> "ControllerLink":
        """Return the link to a controller that somebody else has started, and ends.

        Raises: InputError if the host has no address.
        """
        link = cls.__new__(cls)
        link._open((host, port), None)
        return link

    def _open(self, place: tuple[str, int], process: "subprocess.Popen[str] | None") -> None:
        self._process = process
        self._whose = "the controller process"
        if process is None:
            self._whose = f"the controller at {place[0]}:{place[1]}"
        self._socket = _connected(*place)
        self._socket.setblocking(False)
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._socket, selectors.EVENT_READ)

    def __enter__(self) -> "ControllerLink":
        """Return the link for a `with` block."""
        return self

    def __exit__(self, *_) -> None:
        """End the process of the controller."""
        self.close()

    def start(
        self,
        sequence: int,
        law: int,
        leg: int,
        blend_s: float,
        limit: float,
        first: Sequence[float] | Float[np.ndarray, " p"] = (),
        laws: Sequence[str] = (),
    ) -> Shape:
        """Begin an episode at some commands and wait until the controller is ready.

        Args:
            sequence: number of the start.
            law: number of the law.
            leg: stance leg.
            blend_s: time from holding the first posture to the gait [s].
            limit: torque limit [N m].
            first: commands of the first step.
            laws: names of the laws, for messages.

        Returns: sizes of its robot.
        Raises: InputError if the controller does not start, with its reason if it has one.
        """
        head = _HEAD.pack(b"NGS1", sequence, law, leg)
        self.write(head + np.array([blend_s, limit, *first]).astype("<f8").tobytes())
        deadline = time.monotonic() + _START_TIMEOUT_S
        while time.monotonic() < deadline:
            for packet in self.read(deadline):
                if len(packet) != _HEAD.size:
                    continue
                letters, answered, one, other = _HEAD.unpack(packet)
                if letters == b"NGA1" and answered == sequence:
                    return Shape(one, other)
                if letters == b"NGX1" and answered == sequence:
                    raise self._refusal(one, other, law, len(first), laws)
        raise self.silence("started")

    def silence(self, expected: str) -> InputError:
        """Return the error of a controller that does not answer with the message `expected`."""
        remedy = "report it"
        if self._process is None:
            remedy = "is it running, and exported from this run?"
        return InputError(f"expected {expected} from {self._whose}, found silence: {remedy}")

    def _refusal(
        self, why: int, number: int, law: int, commands: int, laws: Sequence[str]
    ) -> InputError:
        """Return the error of a controller that refuses a start, with its reason."""
        names = dict(enumerate(laws))
        difference, remedy = "a refusal without a reason", "is it exported from this run?"
        if why == _OTHER_LAW:
            own, requested = (names.get(one, f"number {one}") for one in (number, law))
            difference = f"that it has law {own} and not {requested}"
            remedy = f"add law={own} to --link"
        elif why == _OTHER_COMMANDS:
            difference = f"that its gait takes {number} commands, and this one {commands}"
            remedy = "start the controller of this run"
        return InputError(f"expected started from {self._whose}, found {difference}: {remedy}")

    def write(self, packet: bytes) -> None:
        """Send one datagram to the controller. Raises: InputError if nothing listens there."""
        try:
            self._socket.send(packet)
        except OSError as error:
            raise self._no_listener(error) from None

    def read(self, deadline: float) -> list[bytes]:
        """Return datagrams that have come; wait for one until `deadline` (monotonic clock, s).

        Raises: InputError if nothing listens there any more.
        """
        message = self._drain()
        if not message:
            self._selector.select(max(0.0, deadline - time.monotonic()))
            message = self._drain()
        return message

    def close(self) -> None:
        """Close the socket, and end the process if it is ours."""
        if self._process is not None:
            with suppress(InputError):
                self.write(_HEAD.pack(b"NGQ1", 0, 0, 0))
            try:
                self._process.communicate(timeout=_START_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.communicate()
        self._selector.close()
        self._socket.close()

    def _drain(self) -> list[bytes]:
        chunks = []
        while True:
            try:
                chunks.append(self._socket.recv(2048))
            except BlockingIOError:
                return chunks
            except OSError as error:
                raise self._no_listener(error) from None

    def _no_listener(self, error: OSError) -> InputError:
        """Return the error of a socket that nothing listens to."""
        remedy = "report it" if self._process is not None else "start it first, or again"
        return InputError(
            f"expected {self._whose} to listen, found none there ({reason(error)}): {remedy}"
        )


def _connected(host: str, port: int) -> socket.socket:
    """Return a socket that sends to a place. Raises: InputError if there is no such host."""
    try:
        family, kind, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        connection = socket.socket(family, kind)
        try:
            connection.connect(address)
        except OSError:
            connection.close()
            raise
    except (OSError, UnicodeError) as error:
        raise InputError(
            f"link address: expected a host that can be reached, found {host!r} ({reason(error)}): "
            "name another, as in 127.0.0.1:9000"
        ) from None
    return connection
