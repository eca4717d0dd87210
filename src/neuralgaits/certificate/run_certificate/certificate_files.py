"""Write a certificate's files together: new ones replace all of the old ones.

The summary carries the sha256 of the others and is renamed last. So a command that fails leaves the
old certificate, and one that is killed between two renames leaves files that `verified_summary`
does not accept as a certificate.
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path

from neuralgaits.certificate.run_certificate.earlier import refuse_no_place_aside
from neuralgaits.certificate.run_certificate.verified_summary import hashes
from neuralgaits.records.certified import FOLDER, PROOF, SUMMARY
from neuralgaits.runs import packed
from neuralgaits.runs.atomic import refuse_unwritable, write_together
from neuralgaits.runs.names import MAP, MAP_FIGURE

FILES = (PROOF, MAP, MAP_FIGURE)
"""Files of a certificate beside its summary."""
BOXES = "boxes-{}.safetensors"
"""Name of the file of a root's boxes, by the root's number."""


def refuse_unwritable_certificate(run: Path) -> None:
    """Refuse a run whose certificate cannot be written, before the search. Raises: InputError."""
    packed_proof, boxes = packed.packed(run / PROOF), (run / FOLDER).glob(BOXES.format("*"))
    there = [*([packed_proof] if packed_proof.exists() else []), *sorted(boxes)]
    refuse_unwritable(*(run / name for name in (*FILES, SUMMARY)), *there, own=True)
    refuse_no_place_aside(run)


def hashes_with(run: Path, files: Mapping[str, bytes]) -> dict[str, str | None]:
    """Return the sha256 of a certificate's files, if it consists of these."""
    digests = {
        name: hashlib.sha256(files[name]).hexdigest() if name in files else None for name in FILES
    }
    return {name: digests.get(name, digest) for name, digest in hashes(run).items()}


def write_certificate(run: Path, files: Mapping[str, bytes], summary: bytes) -> None:
    """Replace a run's certificate by these files, by name, and its summary.

    Raises: OSError if the system refuses; the old certificate is unchanged then.
    """
    gone = {run / name: None for name in FILES if name not in files}
    if (run / packed.packed(Path(PROOF))).exists():
        gone[run / packed.packed(Path(PROOF))] = None
    write_together({run / name: files[name] for name in files} | {run / SUMMARY: summary} | gone)
