"""Altered logs are read, or refused in one line; many more: benchmarks/fuzz.py."""

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.errors import InputError
from support import amber3m_files
from support.fuzzing.formats import altered

CASES = 60


@pytest.fixture(scope="module", params=["si", "amber3m"])
def content(request, log, tmp_path_factory) -> bytes:
    """Every fourth row of the walk, in one of the formats."""
    file = tmp_path_factory.mktemp("logs") / "walk.csv"
    some = log.only(np.arange(len(log)) % 4 == 0)
    if request.param == "si":
        logs.write(file, some)
    else:
        amber3m_files.write(file, amber3m_files.rows(some))
    return file.read_bytes()


@pytest.mark.filterwarnings("ignore")
def test_an_altered_log_is_read_or_refused(content, amber, tmp_path):
    refused = 0
    for number in range(CASES):
        file = tmp_path / "walk.csv"
        file.write_bytes(altered("walk.csv", content, np.random.default_rng(number)))
        try:
            read, _ = logs.read_all([file], amber)
            logs.cut(read, amber)
        except InputError as error:
            assert "\n" not in str(error)
            refused += 1
    assert 0 < refused < CASES


@pytest.mark.parametrize("path", ["a\x00b.csv", "\ud800.csv"])
def test_a_path_that_no_file_can_have_is_refused(path, amber):
    with pytest.raises(InputError, match="none that can be read"):
        logs.read(path, amber)
