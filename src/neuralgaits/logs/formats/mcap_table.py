"""A table of the numbers in an MCAP file's messages, a row for each message of one topic."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.logs.formats.mcap_reader import McapFile, McapMessage, opened
from neuralgaits.logs.formats.message_fields import Stamp, fields_of
from neuralgaits.logs.formats.sheet import Text

LOG_TIME = "log_time"
"""Column of the time at which a row's message was logged [ns]; it counts from the first row."""
Row = Mapping[str, float | int]


def table_of(path: Path, columns: Sequence[str]) -> Text:
    """Return the table of some columns, named `TOPIC.FIELD`, or `log_time`.

    A row is a message of the topic that most columns are from. To it belong the last messages of
    the other topics, unless one of them is older than 0.05 s or there is none yet: then the row
    is left out, which counts as a gap. Where columns are missing, the table has the names of all
    that there are, and no rows.

    Raises: InputError in one line for a file that is none, is damaged, or has no such messages.
    """
    with opened(path) as file:
        first = {topic: fields_of(one.content) for topic, one in file.first_messages().items()}
        if not first:
            raise _empty(file)
        topic_of = {f"{topic}.{field}": topic for topic, row in first.items() for field in row}
        topic_of[LOG_TIME] = ""
        if not all(name in topic_of for name in columns):
            return Text(path, tuple(topic_of), [], head="its messages")
        topics = [topic_of[name] for name in columns if topic_of[name]]
        if not topics:
            return Text(path, tuple(columns), [], head="its messages")
        main = max(dict.fromkeys(topics), key=topics.count)
        cells = list(_cells(_rows(file, main, set(topics)), columns))
    return Text(path, tuple(columns), cells, head="its messages")


def _empty(file: McapFile) -> InputError:
    others = sorted({f"{one.topic} ({one.encoding})" for one in file.channels.values()})
    channels = f"found {', '.join(others)[:160]}" if others else "found no channel"
    return InputError(
        f"log {file.path}: expected messages in JSON or ROS 2's CDR, {channels}: name a log that "
        "holds some"
    )


def _rows(file: McapFile, main: str, topics: set[str]) -> Iterator[tuple[int, Row]]:
    """Yield the number of each message of a topic, and the numbers of all topics at that time."""
    last: dict[str, McapMessage] = {}
    number = 0
    held_s = 0.05  # Longest time for which the last message of another topic counts [s].
    for message in file.messages(topics):
        last[message.topic] = message
        if message.topic != main:
            continue
        number += 1
        oldest = message.log_time_ns - round(1e9 * held_s)
        if topics <= last.keys() and all(one.log_time_ns >= oldest for one in last.values()):
            row: dict[str, float | int] = {LOG_TIME: Stamp(message.log_time_ns)}
            for topic, one in last.items():
                row |= {f"{topic}.{name}": value for name, value in fields_of(one.content).items()}
            yield number, row


def _cells(
    rows: Iterator[tuple[int, Row]], columns: Sequence[str]
) -> Iterator[tuple[int, list[str]]]:
    """Yield the numbers of rows as text that reads back exactly; empty where there is none."""
    start: dict[str, int] = {}
    for number, row in rows:
        cells = []
        for name in columns:
            value = row.get(name)
            if isinstance(value, Stamp):
                value = int(value) - start.setdefault(name, int(value))
            cells.append("" if value is None else repr(value))
        yield number, cells
