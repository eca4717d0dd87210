"""What the pages for readers hold: code blocks, commands, links and anchors."""

import re
import shlex
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("examples/*/*.md")])
_FENCE = re.compile(r"^```([\w{}-]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_COMMAND = re.compile(r"^(?:\.venv/bin/)?(neuralgaits|make) (.*)$")
_INLINE = re.compile(r"`(neuralgaits [a-z][^`]*)`")
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_HEADING = re.compile(r"^#{1,6} +(.*)$", re.MULTILINE)


class Block(NamedTuple):
    """A fenced block: its language, its text, and the line that it starts on."""

    language: str
    text: str
    line: int


def name(page: Path) -> str:
    """Path of a page within the project."""
    return str(page.relative_to(ROOT))


def read(page: Path) -> str:
    """The text of a page."""
    return page.read_text(encoding="utf-8")


def fences(page: Path) -> list[Block]:
    """All blocks, in order."""
    text = read(page)
    return [
        Block(match[1], match[2], text[: match.start()].count("\n") + 2)
        for match in _FENCE.finditer(text)
    ]


def blocks(page: Path, *languages: str) -> list[Block]:
    """The blocks in one of these languages, in order."""
    return [block for block in fences(page) if block.language in languages]


def files(page: Path) -> dict[str, str]:
    """Files that the page tells its reader to save.

    Python blocks say so in their first line, `# NAME.py, ...`; for others the page says "Saved as
    `NAME`" below.
    """
    found = {}
    for block in blocks(page, "python"):
        if match := re.match(r"# (\w+\.py),", block.text):
            found[match[1]] = block.text
    saved = r"^```(?:xml|toml|text)\n((?:(?!^```).)*?)^```\n+Saved as `([\w.]+)`"
    for match in re.finditer(saved, read(page), re.S | re.M):
        found[match[2]] = match[1]
    return found


def commands(page: Path) -> list[list[str]]:
    """Words of every `neuralgaits` and `make` command on the page, in blocks and in sentences."""
    lines = [line for block in blocks(page, "", "sh") for line in block.text.splitlines()]
    words = [shlex.split(f"{m[1]} {m[2]}", comments=True) for m in map(_COMMAND.match, lines) if m]
    prose = _FENCE.sub("", read(page))
    return words + [shlex.split(text) for text in _INLINE.findall(prose)]


def links(page: Path) -> list[str]:
    """Targets of the links to other places of this project."""
    return links_of(read(page))


def links_of(text: str) -> list[str]:
    """The same of Markdown."""
    prose = re.sub(r"`[^`\n]*`", "", _FENCE.sub("", text))
    return [link for link in _LINK.findall(prose) if not re.match(r"[a-z]+:", link)]


def anchors(page: Path) -> set[str]:
    """Anchors that code hosts make of the headings: small letters, words joined by hyphens."""
    headings = _HEADING.findall(_FENCE.sub("", read(page)))
    return {
        re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings
    }
