"""The program as another program sees it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import neuralgaits
from neuralgaits._environment import THREADS, cores, refuse_settings_without_end
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError

SOURCE = Path(neuralgaits.__file__).parents[1]
DEMO = SOURCE / "neuralgaits" / "demo_run"
ALL_THAT_SAY_IT = """
import json, sys
from pathlib import Path
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate.retrace import retrace_in_subprocess
from neuralgaits.engine.carry import carry_out
from neuralgaits.engine.task import Job
from neuralgaits.errors import InputError
from neuralgaits.workflows.doctor import _device
try:
    retrace_in_subprocess(Path(sys.argv[1]), Theorems())
except InputError as error:
    retrace = str(error)
_, failure, _ = carry_out("jax.numpy:asarray", Job("any", {"x": 1.0}), {})
device = _device()
print(json.dumps({
    "retrace": retrace,
    "worker": [failure.kind, failure.reason],
    "doctor": [device.ok, device.found, device.fix],
}))
"""
"""All places that turn errors into lines but for the command line's own."""


def _python(*arguments: str, cwd: Path, **more: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": str(SOURCE)} | more
    environment.pop("JAX_ENABLE_X64", None)
    return subprocess.run(
        [sys.executable, *arguments], cwd=cwd, env=environment, capture_output=True, text=True
    )


def test_inspect_as_json(tmp_path: Path) -> None:
    done = _python("-m", "neuralgaits", "inspect", "amber3m", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads(done.stdout)
    assert found["underactuation"] == 1
    assert len(found["links"]) == 5
    assert len(found["actuators"]) == 4
    # Two shins, two thighs and the torso of the URDF.
    assert found["mass_kg"] == pytest.approx(2 * 0.85216 + 2 * 3.4261 + 13.0)
    assert found["hip_height_m"] == pytest.approx(0.4667 + 0.4064)
    assert {found["stance_foot"], found["swing_foot"]} == {"foot_left", "foot_right"}


def test_bad_input_is_one_line_and_2(tmp_path: Path) -> None:
    done = _python("-m", "neuralgaits", "inspect", "amber9", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert "amber3m" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_way_to_render_that_is_not_there_is_no_defect(tmp_path: Path) -> None:
    """MuJoCo raises while it is imported."""
    done = _python("-m", "neuralgaits", "inspect", "amber3m", cwd=tmp_path, MUJOCO_GL="crayons")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "neuralgaits: expected MUJOCO_GL to name a way to render that is there, found 'crayons': "
        "unset it, or see `neuralgaits doctor`\n"
    )


def test_a_matplotlibrc_that_cannot_be_read_is_no_defect(tmp_path: Path) -> None:
    (tmp_path / "matplotlibrc").write_bytes(b"# caf\xe9\n")
    done = _python("-m", "neuralgaits", "report", str(DEMO), cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "neuralgaits: expected text in UTF-8 in matplotlibrc, found other bytes: mend or remove "
        "that of this folder, or your own\n"
    )


@pytest.mark.parametrize("named", [None, "MATPLOTLIBRC", "MPLCONFIGDIR"])
def test_settings_of_matplotlib_are_not_waited_for(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    named: str | None,
) -> None:
    os.mkfifo(tmp_path / "matplotlibrc")
    monkeypatch.chdir(tmp_path if named is None else tmp_path.parent)
    if named is not None:
        file = tmp_path / "matplotlibrc" if named == "MATPLOTLIBRC" else tmp_path
        monkeypatch.setenv(named, str(file))
    assert main(["report", str(DEMO)]) == 2
    assert "expected a file to read, found a FIFO at " in capfd.readouterr().err
    (tmp_path / "matplotlibrc").unlink()
    (tmp_path / "matplotlibrc").symlink_to(os.devnull)
    refuse_settings_without_end()


NO_PLATFORM = (
    "expected a platform that JAX finds here, found JAX_PLATFORMS={}: unset it or set it to cpu"
)


@pytest.mark.parametrize("named", ["nonsense", "cpu,nonsense"])
def test_a_platform_that_is_not_there_is_no_defect(tmp_path: Path, named: str) -> None:
    """The second time JAX is asked, it finds the first of several."""
    line = ["-m", "neuralgaits", "export", str(DEMO), "--out", "out"]
    done = _python(*line, cwd=tmp_path, JAX_PLATFORMS=named)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"neuralgaits: {NO_PLATFORM.format(named)}\n"


def test_a_variable_that_jax_cannot_read_is_no_defect(tmp_path: Path) -> None:
    line = ["-m", "neuralgaits", "certify", str(DEMO), "--level", "1"]
    done = _python(*line, cwd=tmp_path, JAX_DEBUG_NANS="maybe")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("neuralgaits: expected values that JAX takes, found ")
    assert "JAX_DEBUG_NANS=maybe" in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("variable", "value", "line"),
    [
        ("JAX_TRANSFER_GUARD", "disallow", ("inspect", "amber3m")),
        ("JAX_DEFAULT_DEVICE", "gpu", ("check-proof", str(DEMO), "--run", str(DEMO))),
    ],
)
def test_settings_of_jax_that_stop_it_are_named(
    tmp_path: Path, variable: str, value: str, line: tuple[str, ...]
) -> None:
    done = _python("-m", "neuralgaits", *line, cwd=tmp_path, **{variable: value})
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "expected JAX to compute as it does without settings, found " in done.stderr
    assert f"{variable}={value}" in done.stderr


@pytest.mark.parametrize("said", ["9" * 5000, "0", "-1", "\u0663", "all"])
def test_threads_that_are_no_number_are_refused(monkeypatch: pytest.MonkeyPatch, said: str) -> None:
    monkeypatch.setenv(THREADS, said)
    with pytest.raises(InputError, match=r"^expected NEURALGAITS_THREADS as a number .{,120}$"):
        cores()
    monkeypatch.setenv(THREADS, "3")
    assert cores() == 3


def test_checkers_and_workers_say_it_too(tmp_path: Path) -> None:
    done = _python("-c", ALL_THAT_SAY_IT, str(DEMO), cwd=tmp_path, JAX_PLATFORMS="nonsense")
    assert done.returncode == 0, done.stderr
    found, fix = NO_PLATFORM.format("nonsense").rsplit(": ", 1)
    assert json.loads(done.stdout) == {
        "retrace": f"{found}: {fix}",
        "worker": ["lost", f"{found}: {fix}"],
        "doctor": [False, found, fix],
    }


def test_importing_does_nothing(tmp_path: Path) -> None:
    code = "import os, sys; e = dict(os.environ); import neuralgaits as ng; ng.__version__; "
    code += "assert 'jax' not in sys.modules; assert dict(os.environ) == e"
    done = _python("-W", "error", "-c", code, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_public_names_exist() -> None:
    assert "open_run" in neuralgaits.__all__
    for name in neuralgaits.__all__:
        assert getattr(neuralgaits, name) is not None
    with pytest.raises(AttributeError, match="walk"):
        neuralgaits.walk  # noqa: B018


@pytest.mark.parametrize("closed", ["1>&-", "2>&-", "1>&- 2>&-"])
@pytest.mark.parametrize(("arguments", "code"), [("--help", 0), ("trian amber3m", 2)])
def test_a_caller_that_closes_a_stream_gets_the_same_exit_code(
    tmp_path: Path, closed: str, arguments: str, code: int
) -> None:
    line = f"exec {sys.executable} -m neuralgaits {arguments} {closed}"
    environment = os.environ | {"PYTHONPATH": str(SOURCE)}
    done = subprocess.run(["sh", "-c", line], cwd=tmp_path, env=environment, capture_output=True)
    assert done.returncode == code
