"""Every command on a page is one: the parser takes its flags, make knows its target."""

import re
from pathlib import Path

import pytest

from neuralgaits.cli.argv_parser import read
from neuralgaits.cli.main import main
from neuralgaits.robots import built_in
from support import pages

ALL = [(pages.name(page), words) for page in pages.PAGES for words in pages.commands(page)]
CHEAP = ("inspect", "robots")
"""Verbs that are carried out, too."""


@pytest.mark.parametrize(
    "words",
    [words[1:] for _, words in ALL if words[0] == "neuralgaits"],
    ids=[f"{page}: {' '.join(words)}" for page, words in ALL if words[0] == "neuralgaits"],
)
def test_the_parser_takes_it(words):
    # A placeholder is as good as a path; "..." stands for more of them.
    assert read([word for word in words if word != "..."])


def cheap(page):
    """Those of a page that can be carried out: no placeholder stands in them, and no other file."""
    there = {*pages.files(page), *built_in()}
    return [
        words[1:]
        for words in pages.commands(page)
        if words[0] == "neuralgaits"
        and words[1] in CHEAP
        and not any(re.match(r"[A-Z]+\b", word) for word in words)
        and (len(words) < 3 or words[2] in there)
    ]


@pytest.mark.parametrize("page", [p for p in pages.PAGES if cheap(p)], ids=pages.name)
def test_cheap_ones_run(page, place, capsys):
    for name, text in pages.files(page).items():
        (place / name).write_text(text, encoding="utf-8")
    for words in cheap(page):
        assert main(words) == 0, words
        assert capsys.readouterr().out


@pytest.mark.parametrize("page", pages.PAGES, ids=pages.name)
def test_no_block_and_no_line_is_passed_over(page):
    """Fences that look otherwise, and commands of other programs, would not be looked at."""
    fences = re.findall(r"^\s*(?:```|~~~)", pages.read(page), re.MULTILINE)
    assert len(fences) == 2 * len(pages.fences(page))
    known = {"neuralgaits", "make", "pip", "proofcheck", "g++", "#", "W=$(python"}
    lines = [line for block in pages.blocks(page, "", "sh") for line in block.text.splitlines()]
    assert {Path(line.split()[0]).name for line in lines if line} <= known


def test_make_knows_its_targets():
    asked = [words[1:] for _, words in ALL if words[0] == "make"]
    assert asked
    for words in asked:
        folder = Path(words[words.index("-C") + 1]) if "-C" in words else Path()
        makefile = (pages.ROOT / folder / "Makefile").read_text(encoding="utf-8")
        targets = [w for w in words if "=" not in w and w != "-C" and Path(w) != folder]
        for target in targets:
            assert re.search(rf"^{re.escape(target)}:", makefile, re.MULTILINE), words


def test_the_checker_is_compiled_on_its_page_as_by_make():
    """The page's line has the flags of the Makefile, warnings aside."""
    makefile = (pages.ROOT / "Makefile").read_text(encoding="utf-8")
    rule = makefile.split("build/proofcheck: ")[1].split("$(CXX) ")[1].split("$<")[0]
    flags = " ".join(flag for flag in rule.split() if not flag.startswith("-W"))
    assert "-frounding-math" in flags
    page = (pages.ROOT / "docs" / "checkers.md").read_text(encoding="utf-8")
    assert f"g++ {flags} tools/proofcheck/proofcheck.cpp -o proofcheck\n" in page


def test_names_in_c_exist():
    """Functions and constants of the blocks in C are those of the exporter or of a main loop."""
    folders = pages.ROOT / "src" / "neuralgaits", pages.ROOT / "examples"
    kinds = {".c", ".cpp", ".h", ".hpp", ".py"}
    sources = [file for folder in folders for file in folder.rglob("*") if file.suffix in kinds]
    written = "\n".join(file.read_text(encoding="utf-8") for file in sources)
    shown = [block for page in pages.PAGES for block in pages.blocks(page, "c")]
    assert shown
    for block in shown:
        for name in set(re.findall(r"\bng_\w+|\bNG_\w+", block.text)):
            assert re.search(rf"\b{name}\b", written), name
