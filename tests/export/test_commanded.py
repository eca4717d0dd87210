"""A controller that is told commands: C against Python, wishes and touchdowns among the cases."""


import pytest

from neuralgaits.export import build
from neuralgaits.export.compare import agree, limits, questions
from neuralgaits.export.reference import Reference
from neuralgaits.export.selftest import selftest_file
from neuralgaits.export.source import gait_files
from support.compiled import folder_with
from support.designs import FOOTHOLDS, LAWS, SPEED, commanded_design

pytestmark = pytest.mark.slow
STATES = 1000


def files_of(design, reference):
    return gait_files(design) | {"gait_selftest.h": selftest_file(design, reference)}


def compiled(folder, files, flags=()):
    return build.build("gcc", folder_with(folder, files), "check", build.CHECKED, ("-O2", *flags))


@pytest.fixture(scope="module", params=[(SPEED,), FOOTHOLDS], ids=["speed", "footholds"])
def told(request):
    return commanded_design("amber3m", LAWS, request.param)


@pytest.fixture(scope="module")
def files(told):
    return files_of(told, Reference(told))


@pytest.fixture(scope="module")
def asked(told):
    return questions(told, Reference(told), STATES)


def test_c_does_what_python_does(told, files, asked, tmp_path):
    for precision, defines in build.PRECISIONS.items():
        agreement = agree(told, asked, compiled(tmp_path, files, defines), precision)
        asking = limits(told, precision)
        assert max(agreement.output, agreement.rate) <= asking.output
        assert 0.0 < agreement.torque <= asking.torque
