"""Read YAML as a tree of texts, with the line of each: strict, small and without surprises.

YAML 1.1 reads `on` as a truth value, `1e-3` as a text and `1:30` as 90. Here every scalar stays the
text that stands in the file, and whoever asks for a number says so. Anchors, aliases and tags,
which can make a small file a large one, are refused, and so are keys that stand twice.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralgaits._inputs import no_file_at, refuse_unreadable
from neuralgaits._printable import printable, shown
from neuralgaits.errors import InputError, ManyProblems


@dataclass(frozen=True)
class YamlNode:
    """A part of a YAML file.

    Attributes:
        value: a text, a list of nodes, or a dict of nodes by key.
        line: line where it begins, from 1.
    """

    value: "str | list[YamlNode] | dict[str, YamlNode]"
    line: int

    @property
    def kind(self) -> str:
        """Kind of the value, in words."""
        if isinstance(self.value, str):
            return shown(self.value)
        return "a list" if isinstance(self.value, list) else "keys with values"


def yaml_tree(path: Path) -> YamlNode:
    """Return the contents of a YAML file.

    Raises: InputError in one line if there is no such file, if it is too large or no UTF-8, or if
        it is no YAML of this kind; ManyProblems if keys stand in it twice.
    """
    try:
        import yaml
    except ModuleNotFoundError:
        raise InputError(
            "expected the package pyyaml for a deployment file, found none: "
            "pip install 'neuralgaits[deploy]'"
        ) from None
    text = _text_of(path)
    try:
        _refuse_events(yaml.parse(text, Loader=yaml.BaseLoader), path)
        node = yaml.compose(text, Loader=yaml.BaseLoader)
    except yaml.YAMLError as error:
        raise InputError(f"{printable(path)}: expected YAML, found {_message(error)}") from None
    if node is None:
        raise InputError(f"{printable(path)}: expected keys with values, found an empty file")
    twice: list[str] = []
    tree = _converted(node, printable(path), twice)
    if twice:
        raise ManyProblems(twice)
    return tree


def _text_of(path: Path) -> str:
    most_bytes = 2**16  # Largest file that is read: twenty times one of a robot with twelve joints.
    refuse_unreadable(path, most_bytes, "it is no deployment file")
    if not path.is_file():
        raise InputError(
            f"expected a deployment file, found {no_file_at(path, 'none')} at {printable(path)}: "
            "write one with `neuralgaits export`"
        )
    try:
        return path.read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{printable(path)}: expected UTF-8, found byte {error.object[error.start]:#04x} at "
            f"position {error.start}: save it as UTF-8"
        ) from None


def _refuse_events(events: Any, path: Path) -> None:
    """Refuse anchors, aliases, tags and deep nesting before anything is built."""
    depth = 0
    most_depth = 20  # Deepest nesting; a deployment file has three levels.
    for event in events:
        name = type(event).__name__
        depth += name.endswith("StartEvent") - name.endswith("EndEvent")
        line = event.start_mark.line + 1
        if depth > most_depth:
            raise InputError(
                f"{printable(path)}, line {line}: expected at most {most_depth} levels, found "
                "more: is it the right file?"
            )
        if getattr(event, "anchor", None):
            raise InputError(
                f"{printable(path)}, line {line}: expected plain values, found the anchor or "
                f"alias {shown(event.anchor)}: write the value where it belongs"
            )
        if getattr(event, "tag", None):
            raise InputError(
                f"{printable(path)}, line {line}: expected plain values, found the tag "
                f"{shown(event.tag)}: delete it"
            )


def _converted(node: Any, path: str, twice: list[str]) -> YamlNode:
    """Return a node of PyYAML as one of this module; note keys that stand twice."""
    line = node.start_mark.line + 1
    if node.id == "scalar":
        return YamlNode(node.value, line)
    if node.id == "sequence":
        return YamlNode([_converted(one, path, twice) for one in node.value], line)
    nodes: dict[str, YamlNode] = {}
    for key, value in node.value:
        at = key.start_mark.line + 1
        if key.id != "scalar":
            raise InputError(f"{path}, line {at}: expected a key, found a {key.id}: write a name")
        if key.value in nodes:
            twice.append(
                f"{path}, line {at}: expected each key once, found {shown(key.value)} again, "
                f"first in line {nodes[key.value].line}: delete one"
            )
            continue
        nodes[key.value] = _converted(value, path, twice)
    return YamlNode(nodes, line)


def _message(error: Any) -> str:
    """Return what PyYAML found, with the line, in a few words."""
    mark = getattr(error, "problem_mark", None)
    problem = getattr(error, "problem", None) or getattr(error, "reason", None) or "something else"
    where = "" if mark is None else f" in line {mark.line + 1}"
    return f"{problem}{where}: indent by blanks, and write `key: value`"
