"""Settings of the link of plant and controller: the values of `--link NAME=VALUE,...`."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from neuralgaits._checks import listed
from neuralgaits._digits import decimal
from neuralgaits._printable import shown
from neuralgaits.errors import InputError


@dataclass(frozen=True)
class LinkConfig:
    """Settings of the link of plant and controller.

    Attributes:
        law: name of the exported law; if empty, the default law of an export.
        lockstep: wait for every answer instead of keeping time.
        loss: probability that a packet is lost, each way.
        jitter_ms: packets are late by up to this much, each way, whole milliseconds.
        blend_s: time of the change from holding the first posture to the gait [s].
        log: file for the first controller's own log, in the format of AMBER-3M; none if empty.
        address: HOST:PORT of a controller that the user has started; if empty, the run's own is
            compiled and started.
    """

    law: str = ""
    lockstep: bool = False
    loss: float = 0.0
    jitter_ms: float = 0.0
    blend_s: float = 0.0
    log: str = ""
    address: str = ""

    def __post_init__(self):
        """Check each value against its range. Raises: InputError."""
        ranges = {"loss": (0.0, 0.5), "jitter_ms": (0.0, 20.0), "blend_s": (0.0, 10.0)}
        for name, (low, high) in ranges.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputError(f"link {name}: expected {low:g} to {high:g}, found {value:g}")
        if self.jitter_ms != int(self.jitter_ms):
            raise InputError(
                f"link jitter_ms: expected whole milliseconds, found {self.jitter_ms:g}"
            )
        if self.address:
            _ = self.host_and_port
            if self.log:
                raise InputError(
                    "expected link log without address, found both: the log is written by the "
                    "controller, so give --log to the one that you started"
                )

    @property
    def host_and_port(self) -> tuple[str, int]:
        """Return the two parts of the address. Raises: InputError for anything else."""
        host, colon, port = str(self.address).rpartition(":")
        number = int(port) if port.isascii() and port.isdigit() and len(port) < 6 else 0
        ports = 2**16
        if not (colon and host and 0 < number < ports):
            raise InputError(
                f"link address: expected HOST:PORT with a port from 1 to {ports - 1}, found "
                f"{shown(self.address)}: write it as in 127.0.0.1:9000"
            )
        return host.removeprefix("[").removesuffix("]"), number


def parse_link(text: "str | Mapping[str, Any] | LinkConfig | None") -> LinkConfig:
    """Read `NAME=VALUE,...`. Raises: InputError listing the names."""
    if isinstance(text, LinkConfig):
        return text
    if text is not None and not isinstance(text, str | Mapping):
        raise InputError(f"link: expected NAME=VALUE,... or a mapping, found {shown(text)}")
    if not text:
        return LinkConfig()
    pairs = dict(text) if isinstance(text, Mapping) else _pairs(text)
    kinds = {entry.name: entry.type for entry in fields(LinkConfig)}
    values: dict[str, Any] = {}
    for name, value in pairs.items():
        if name not in kinds:
            raise InputError(f"unknown link setting {name!r}: expected one of {', '.join(kinds)}")
        try:
            number = value if kinds[name] is str else decimal(value)
        except (TypeError, ValueError):
            raise InputError(f"link {name}: expected a number, found {value!r}") from None
        if name == "lockstep":
            if number not in (0.0, 1.0):
                raise InputError(f"link lockstep: expected 0 or 1, found {value}")
            number = bool(number)
        values[name] = number
    return LinkConfig(**values)


def _pairs(text: str) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for part in listed("link", text):
        name, equals, value = part.partition("=")
        if not equals:
            raise InputError(f"link: expected NAME=VALUE,..., found {part!r}")
        name = name.strip()
        if name in pairs:
            raise InputError(f"link {name} is given twice: give it once")
        pairs[name] = value.strip()
    return pairs
