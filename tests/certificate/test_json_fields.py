"""Untrusted JSON: no text that a screen would obey, however it is written down."""

import json

import pytest

from neuralgaits.certificate.proof_file.json_fields import parse

ODD = ["\x1b[2J", "a\u202eb", "a\u2028b", "a\nb", "tab\t", "\ud800", "\x7f", "\u200b"]


@pytest.mark.parametrize("ascii_only", [True, False])
@pytest.mark.parametrize("text", ODD, ids=ascii)
def test_text_that_cannot_be_printed_is_refused(text, ascii_only):
    """As a value, as a name and deep inside, escaped or as it is."""
    for table in ({"a": text}, {text: 1.0}, {"a": [{"b": ["c", text]}]}):
        with pytest.raises(ValueError, match="cannot be printed"):
            parse(json.dumps(table, ensure_ascii=ascii_only))


def test_a_raw_control_character_is_no_json():
    for control in "\n\r\t\x1b":
        with pytest.raises(ValueError, match="control character"):
            parse(f'{{"a": "x{control}y"}}')


@pytest.mark.parametrize("ascii_only", [True, False])
def test_what_can_be_printed_comes_back(ascii_only):
    """With space between the words, quotes, backslashes and letters of other alphabets."""
    table = {"name": 'a "b" \\ c/d', "größe": ["µ", "距離"], "n": [1, 2.5, None, True]}
    text = json.dumps(table, ensure_ascii=ascii_only, indent="\t").replace("\n", "\r\n")
    assert parse(text) == table
    assert parse(json.dumps(table, ensure_ascii=ascii_only)) == table
