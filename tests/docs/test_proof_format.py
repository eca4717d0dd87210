"""The page about the proof file's format lists what the readers accept."""

import json
import re

from neuralgaits.certificate.proof_file import reader
from neuralgaits.programs import ops
from support import pages
from support.shipped_run import SHIPPED


def section(title):
    text = (pages.ROOT / "docs" / "proof_format.md").read_text()
    return text.split(f"\n## {title}\n")[1].split("\n## ")[0]


def first_cells(title):
    rows = re.findall(r"^\| (`[^|]+) \|", section(title), re.MULTILINE)
    return [word for row in rows for word in re.findall(r"`([^`]+)`", row)]


def test_the_page_lists_every_field():
    assert set(first_cells("The object")) == reader.FIELDS
    assert set(first_cells("A statement")) == reader.STATEMENT_FIELDS
    proof = json.loads((SHIPPED / "certificate" / "proof.json").read_text())
    program = proof["program"]
    program = json.loads(program) if isinstance(program, str) else program
    listed = first_cells("The Program")
    assert set(program) <= set(listed)
    assert set(listed) == set(program) | set(ops.KINDS)


def test_the_page_names_the_format():
    assert f'{reader.FORMAT} and `"{reader.KIND}"`' in section("The object")
    assert f"more than {reader.MAX_CUTS} times" in section("A statement")
