"""The part of the page about commands: those that the gait takes, and what is proved for them."""

from collections.abc import Iterator, Mapping

from neuralgaits.records import certificate_sentences
from neuralgaits.records.training_config import Range
from neuralgaits.report.drawing import command_words
from neuralgaits.report.drawing.figure_files import FigureFiles
from neuralgaits.report.page.markup import Html, captioned, paragraph, section, table, tag
from neuralgaits.report.page.saved import Contents, ProvedOfSome, RunContents


def family(contents: Contents, pictures: Mapping[str, Html]) -> Iterator[Html]:
    """Yield the section on the gait's commands and its figure; nothing for a gait without commands.

    Args:
        contents: contents of the page.
        pictures: an image element for each drawn figure, by name.
    """
    commands = contents.saved.config.commands
    if not commands:
        return
    yield section(
        "told",
        "Its commands",
        paragraph(_command_ranges(commands)),
        _ranges(commands),
        paragraph(*_proved(contents.saved)),
        *_figure(contents, pictures),
        paragraph(
            "Other figures of the gait as it is designed show the one in the middle of every "
            "range.",
            class_="quiet",
        ),
    )


def _command_ranges(commands: Mapping[str, Range]) -> str:
    what = " and ".join(command_words.words(name).whole for name in commands)
    sentence = (
        f"At each touchdown this robot gets commands for its next step: {what}. One network "
        "serves all of them. It also knows the commands of the step before, because that decides "
        "in which posture this one begins. What is out of range is taken as the nearest value in it"
    )
    spread = any(one.largest_change is not None for one in commands.values())
    return (
        f"{sentence}, and too large a change is spread over several steps."
        if spread
        else f"{sentence}."
    )


def _ranges(commands: Mapping[str, Range]) -> Html:
    rows = [
        (
            command_words.words(name).short,
            command_words.written(name, one.low),
            command_words.written(name, one.high),
            "any"
            if one.largest_change is None
            else command_words.written(name, one.largest_change),
        )
        for name, one in commands.items()
    ]
    head = ("command", "from", "to", "change a step, at most")
    return table("Commands of the gait", head, rows, numbers=" nnn", cards=True)


def _proved(saved: RunContents) -> Iterator[Html | str]:
    """Yield for which commands something is proved, and what it states."""
    certificate, link = saved.certificate, tag("a", "The certificate", href="#certificate")
    if certificate is None:
        yield "Nothing is proved for any of these commands."
        return
    if saved.of_some is not None:
        yield from _of_some(saved.of_some, len(certificate.conditions))
        return
    if not saved.proved_level:
        count = sum(entry.verdict == "proved" for entry in certificate.conditions.values())
        yield (
            f"{count} of {len(certificate.conditions)} conditions are proved for all of these "
            "commands. "
        )
        yield link
        yield " names the others."
        return
    yield tag("b", f"Proved for all of these commands, to level {saved.proved_level}: ")
    yield f"{_statements(saved.proved_level)}. "
    yield link
    yield " has the statements, and what they assume."


def _of_some(part: ProvedOfSome, count: int) -> Iterator[Html | str]:
    if not part.conditions:
        yield "Nothing is proved for any of these commands."
        return
    ranges = "; ".join(_range(name, one) for name, one in part.ranges.items())
    where = f": {ranges}" if ranges else ", of which the proof file has the pairs"
    yield tag("b", f"Proved for some of these commands only{where}. ")
    yield "There, "
    if part.level:
        yield _statements(part.level)
    else:
        conditions = f"{part.conditions} of {count} conditions hold at every state of their regions"
        yield certificate_sentences.states_with_commands((), conditions)
    yield ". Of all other commands nothing is proved."


def _range(name: str, one: Range) -> str:
    """Describe commands with a proof; rounding never widens their range."""
    low, high = command_words.within(name, one.low, one.high)
    change = "any after any"
    if one.largest_change is not None:
        change = (
            f"changing by at most {command_words.change_within(name, one.largest_change)} a step"
        )
    return f"{command_words.words(name).short} from {low} to {high}, {change}"


def _statements(level: int) -> str:
    return certificate_sentences.states_with_commands(range(1, level + 1))


def _figure(contents: Contents, pictures: Mapping[str, Html]) -> Iterator[Html]:
    """Yield the figure, or one line that says why it is missing."""
    for figure in contents.figures:
        if figure.name not in command_words.FIGURES:
            continue
        if isinstance(figure, FigureFiles):
            yield captioned(figure.title, figure.caption, pictures[figure.name])
        else:
            link = tag("a", "What is missing", href="#missing")
            sentence = f"“{figure.title}” is not drawn: {figure.reason}. "
            yield paragraph(sentence, link, " has the command.", class_="quiet")
