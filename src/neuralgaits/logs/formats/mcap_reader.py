"""MCAP files: which channels they have, and their messages in order, decoded.

Messages in JSON and in ROS 2's CDR are decoded, whatever their schema. Source of the format:
https://mcap.dev/spec.
"""

import importlib.util
import json
from collections.abc import Callable, Iterator, Set
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from neuralgaits._inputs import MOST_LOG_BYTES, refuse_unreadable
from neuralgaits.errors import InputError, reason

SUFFIX = ".mcap"
_MAGIC = b"\x89MCAP0\r\n"
"""First bytes of every MCAP file, and its last."""


class McapMessage(NamedTuple):
    """A message: its topic, the time at which it was logged [ns], and its decoded content."""

    topic: str
    log_time_ns: int
    content: Any


class McapChannel(NamedTuple):
    """A channel of a file. Attributes: schema: its name and text; decode: None if nothing can."""

    topic: str
    encoding: str
    schema: tuple[str, str]
    decode: Callable[[bytes], Any] | None


class McapFile:
    """An MCAP file, open. Attributes: path: its path; channels: by their number in the file."""

    def __init__(self, path: Path, reader: Any):
        """Read its channels, in one pass over the file if it has no summary."""
        from mcap_ros2.decoder import DecoderFactory

        self.path, self._reader = path, reader
        factory = DecoderFactory()
        self.channels: dict[int, McapChannel] = {}
        for schema, channel in self._channels():
            encoding = channel.message_encoding
            decode = json.loads if encoding == "json" else factory.decoder_for(encoding, schema)
            about = ("", "") if schema is None else (schema.name, schema.data.decode())
            self.channels[channel.id] = McapChannel(channel.topic, encoding, about, decode)

    def _channels(self) -> Iterator[tuple[Any, Any]]:
        """Yield the schema and the record of each channel."""
        summary = self._reader.get_summary()
        if summary is not None and summary.channels:
            sizes = sum(chunk.uncompressed_size for chunk in summary.chunk_indexes)
            if sizes > MOST_LOG_BYTES:
                raise InputError(
                    f"log {self.path}: expected at most {MOST_LOG_BYTES} bytes of messages, found "
                    f"{sizes}: cut it with `mcap filter`"
                )
            for channel in summary.channels.values():
                yield summary.schemas.get(channel.schema_id), channel
            return
        channels = {c.id: (schema, c) for schema, c, _ in self._reader.iter_messages()}
        yield from channels.values()

    @property
    def topics(self) -> list[str]:
        """Topics that can be decoded, sorted."""
        return sorted({one.topic for one in self.channels.values() if one.decode is not None})

    def first_messages(self) -> dict[str, McapMessage]:
        """Return the first message of each topic that can be decoded, in one pass over the file.

        It ends where every topic that has messages was seen.
        """
        topics = set(self.topics)
        awaited = topics - self._silent()
        messages: dict[str, McapMessage] = {}
        for _, channel, message in self._reader.iter_messages(topics=topics):
            decode = self.channels[channel.id].decode
            if decode is not None and channel.topic not in messages:
                content = decode(message.data)
                messages[channel.topic] = McapMessage(channel.topic, message.log_time, content)
                awaited.discard(channel.topic)
                if not awaited:
                    break
        return {topic: messages[topic] for topic in sorted(messages)}

    def _silent(self) -> set[str]:
        """Return the topics that have no message, as far as the file says so."""
        summary = self._reader.get_summary()
        if summary is None or summary.statistics is None:
            return set()
        counts = summary.statistics.channel_message_counts
        topics = {one.topic for number, one in self.channels.items() if counts.get(number)}
        return {one.topic for one in self.channels.values()} - topics

    def messages(self, topics: Set[str]) -> Iterator[McapMessage]:
        """Yield the messages of some topics in the order of their log times."""
        for _, channel, message in self._reader.iter_messages(topics=topics):
            topic = self.channels[channel.id]
            if topic.decode is not None:
                yield McapMessage(topic.topic, message.log_time, topic.decode(message.data))


def is_mcap(path: Path) -> bool:
    """Return whether a file is read as MCAP: by its name, or by its first bytes."""
    if path.suffix.lower() == SUFFIX:
        return True
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            return file.read(len(_MAGIC)) == _MAGIC
    except (OSError, ValueError):
        return False


def refuse_without_extra(path: Path) -> None:
    """Refuse an MCAP file where the packages for it are not installed. Raises: InputError."""
    missing = [name for name in ("mcap", "mcap_ros2") if importlib.util.find_spec(name) is None]
    if missing:
        raise InputError(
            f"log {path}: expected the package {missing[0]} for an MCAP file, found none: "
            "pip install 'neuralgaits[mcap]'"
        )


@contextmanager
def opened(path: Path) -> Iterator[McapFile]:
    """Open an MCAP file.

    Raises: InputError in one line if the extra is missing, if it is no MCAP file, and, while its
        messages are read as well, if it is damaged or was not closed.
    """
    refuse_without_extra(path)
    refuse_unreadable(path, MOST_LOG_BYTES)
    from mcap.reader import make_reader

    try:
        with path.open("rb") as stream:
            _refuse_other_kind(path, stream.read(len(_MAGIC)))
            stream.seek(0)
            yield McapFile(path, make_reader(stream, validate_crcs=True))
    except InputError:
        raise
    except OSError as error:
        raise InputError(
            f"log {path}: expected an MCAP file, found none that can be read ({reason(error)}): "
            "name the file that the robot wrote"
        ) from None
    # Damaged bytes make readers, decompressors and decoders fail, each in a way of its own.
    except Exception as error:
        why = " ".join(str(error).split())[:80] or type(error).__name__
        raise InputError(
            f"log {path}: expected a whole MCAP file, found a damaged one or one that was not "
            f"closed ({why}): repair it with `mcap recover`, or log again"
        ) from None


def _refuse_other_kind(path: Path, first: bytes) -> None:
    if first != _MAGIC:
        raise InputError(
            f"log {path}: expected an MCAP file, whose first bytes are {_MAGIC[:6]!r}, found "
            f"{first[:6]!r}: name a log in MCAP, or end the name of a CSV file in .csv"
        )
