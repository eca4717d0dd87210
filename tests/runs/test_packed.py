"""A packed file is read as what it holds, and what is no such file is said to be none."""

import gzip
import hashlib
import shutil
from pathlib import Path

import pytest

from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.errors import InputError
from neuralgaits.records.certified import PROOF, SUMMARY
from neuralgaits.runs import RunFolder, packed
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.workflows import demo
from neuralgaits.workflows.report import saved_of


@pytest.fixture
def run(tmp_path):
    """A proved run whose proof lies packed."""
    folder = shutil.copytree(demo.FOLDER, tmp_path / "run")
    whole = folder / PROOF
    packed.packed(whole).write_bytes(gzip.compress(whole.read_bytes()))
    whole.unlink()
    return folder


def test_a_packed_proof_is_the_proof(run):
    plain = demo.FOLDER / PROOF
    assert packed.content(run / PROOF) == plain.read_bytes()
    wanted = hashlib.sha256(plain.read_bytes()).hexdigest()
    assert file_hashes(run, (PROOF,)) == {PROOF: wanted}
    for name in (run / PROOF, packed.packed(run / PROOF)):
        assert read_claims(name).program.hash == read_claims(plain).program.hash
    found = read_certificate(RunFolder.open(run))
    assert found.reason is None and found.summary is not None
    assert [level.verdict for level in found.summary.levels] == ["proved", "proved"]


def test_the_plain_file_is_the_one_that_counts(run):
    (run / PROOF).write_text("{}")
    assert packed.content(run / PROOF) == b"{}"
    packed.remove(run / PROOF)
    assert not packed.is_there(run / PROOF)


def _cut(content):
    return content[:1000]


def _flipped(content):
    """A byte of the checksum: all of the text is read before it is seen."""
    return content[:-6] + bytes([content[-6] ^ 0xFF]) + content[-5:]


@pytest.mark.parametrize("damage", [lambda _: b"", lambda _: b"no gzip", _cut, _flipped])
def test_a_damaged_one_is_refused_in_one_line(run, damage):
    place = packed.packed(run / PROOF)
    place.write_bytes(damage(place.read_bytes()))
    with pytest.raises(InputError, match="expected a proof file") as refused:
        read_claims(run / PROOF)
    assert "\n" not in str(refused.value)
    found = read_certificate(RunFolder.open(run))
    assert found.summary is None and "proof.json.gz is damaged" in str(found.reason)
    assert file_hashes(run, (PROOF,)) == {PROOF: None}
    saved = saved_of(RunFolder.open(run), found)
    assert "proof.json.gz is damaged" in saved.damaged[SUMMARY]


def test_a_plain_file_that_is_named_as_a_packed_one_is_said_to_be_plain(run):
    place = packed.packed(run / PROOF)
    place.write_bytes(gzip.decompress(place.read_bytes()))
    with pytest.raises(InputError, match=r"proof.json.gz is JSON .*: rename it to proof.json; "):
        read_claims(place)


def test_one_that_holds_too_much_is_refused(run, monkeypatch):
    monkeypatch.setattr(packed, "LARGEST_BYTES", 50_000)
    with pytest.raises(InputError, match="holds more than 50000 bytes"):
        read_claims(run / PROOF)


@pytest.mark.parametrize("place", ["", ".", "/"])
def test_a_folder_without_a_name_is_called_a_folder(place):
    with pytest.raises(InputError, match="found none to read: Is a directory; name a run"):
        read_claims(Path(place))
