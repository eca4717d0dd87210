"""The verb: files whole or not at all, checked or said not to be."""

import json
import shutil
import subprocess
from dataclasses import replace

import jax
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.cli.export_screen import show_export
from neuralgaits.errors import InputError, MismatchError, RunError, SpecError
from neuralgaits.export import build
from neuralgaits.runs import to_json
from neuralgaits.workflows import demo, export_formats
from neuralgaits.workflows import export as workflow
from neuralgaits.workflows.export import export_controller
from support.refuted_run import refute

pytestmark = pytest.mark.slow

FIELDS = {"files", "max_abs_error", "latency_us", "flash_bytes", "ram_bytes"}
STATES = 500


@pytest.fixture(scope="module", autouse=True)
def one_compiler():
    """The first is enough here: what another makes of the same C is seen in every export."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "COMPILERS", build.COMPILERS[:1])
        yield


@pytest.fixture(scope="module")
def exported(trained, tmp_path_factory):
    out = tmp_path_factory.mktemp("export") / "new" / "c"
    return out, export_controller(trained, out, states=STATES)


def test_what_is_printed(exported):
    out, done = exported
    summary = json.loads(to_json(done.summary))
    assert FIELDS <= set(summary) and done.checked
    assert sorted(str(path) for path in out.iterdir()) == summary["files"]
    assert 0.0 < summary["max_abs_error"] < 1e-10
    assert 0.0 < summary["latency_us"]["p50"] <= summary["latency_us"]["p99"]
    assert 10_000 < summary["flash_bytes"] < 100_000
    assert summary["ram_bytes"] <= 4096 + sum(summary["sizes"]["double"]["structs"].values())
    precisions = {(row["precision"], row["flags"]) for row in summary["builds"]}
    assert len(precisions) == 4
    assert summary["float_bound"]["output"] >= summary["builds"][2]["agreement"]["output"]


def test_a_gait_without_a_proof_is_exported_with_a_warning(exported, tmp_path, capsys):
    """And one that is refuted with the state that breaks it; a proved one without."""
    _, done = exported
    assert done.summary["warnings"] == ["nothing is proved of this gait: it has no certificate"]
    show_export(done.summary)
    assert "warning: nothing is proved of this gait" in " ".join(capsys.readouterr().out.split())
    proved = open_run(shutil.copytree(demo.FOLDER, tmp_path / "run"))

    def warnings():
        return workflow.unproved_of_export(read_certificate(proved.folder))

    assert warnings() == []
    file = proved.path / "certificate" / "summary.json"
    refute(proved.path, "knee")
    answer = json.loads(file.read_text())
    answer["levels"][1]["reason"] = "time was up"
    file.write_text(json.dumps(answer))
    refuted, _, undecided = warnings()
    assert all(fact in refuted for fact in ("refuted", "knee", "0.0125 m", "14.25 kg m²/s"))
    assert "level 3 is not proved" in undecided and "time was up" in undecided
    (proved.path / "certificate" / "proof.json").unlink()
    (one,) = warnings()
    assert one.startswith("nothing is proved of this gait: certificate/proof.json is missing")


def test_the_files_compile_where_they_are(exported, tmp_path):
    """Whoever has the folder needs nothing else."""
    out, _ = exported
    main = tmp_path / "main.c"
    main.write_text('#include "controller.h"\nint main(void) { return ng_selftest(); }\n')
    program = tmp_path / "selftest"
    sources = [str(out / name) for name in ("gait.c", "controller.c", "selftest.c")]
    subprocess.run(
        ["gcc", *build.STRICT, "-Os", "-I", str(out), str(main), *sources, "-o", str(program)],
        check=True,
    )
    assert subprocess.run([str(program)]).returncode == 0


def test_hashes_are_those_of_the_run(exported, trained):
    import hashlib

    out, _ = exported
    text = (out / "gait.h").read_text()
    for name in ("robot.xml", "policy.safetensors"):
        assert hashlib.sha256((trained.path / name).read_bytes()).hexdigest() in text


@pytest.mark.parametrize("format", ["c", "onnx"])
@pytest.mark.parametrize("factor", [0.0, 1e300])
def test_weights_that_no_controller_can_use_are_refused(trained, factor, format, tmp_path, recwarn):
    run = replace(trained, trained=jax.tree.map(lambda leaf: factor * leaf, trained.trained))
    with pytest.raises(InputError, match=r"expected .*(finite|weights and momenta)"):
        export_controller(run, tmp_path / "c", format=format, states=STATES)
    assert not list(tmp_path.iterdir()) and not recwarn.list


def test_a_used_folder_is_refused_without_force(exported, trained, monkeypatch):
    out, _ = exported
    begun = []
    with pytest.raises(InputError, match=r"expected an empty folder .* --force"):
        export_controller(trained, out, states=STATES, begun=lambda: begun.append(1))
    assert not begun
    (out / "mine.txt").write_text("kept")
    (out / "gait.h").write_text("spoilt")
    monkeypatch.setattr(build, "compilers", list)
    export_controller(trained, out, force=True, states=STATES, begun=lambda: begun.append(1))
    assert begun and (out / "mine.txt").read_text() == "kept"
    assert "NG_ROBOT" in (out / "gait.h").read_text()
    (out / "mine.txt").unlink()


def test_a_file_in_the_way_is_refused(trained, tmp_path):
    (tmp_path / "c").write_text("")
    with pytest.raises(InputError, match=r"expected a folder"):
        export_controller(trained, tmp_path / "c", force=True)


def test_without_a_compiler_files_are_written_and_not_checked(trained, tmp_path, monkeypatch):
    monkeypatch.setattr(build, "compilers", list)
    done = export_controller(trained, tmp_path / "c")
    assert not done.checked and done.summary["checked"] is False
    assert "not checked" in done.summary["reason"]
    assert (tmp_path / "c" / "gait.c").stat().st_size > 10_000
    assert FIELDS <= set(done.summary)


def test_a_mismatch_leaves_nothing(trained, tmp_path, monkeypatch):
    real = export_formats.gait_files

    def spoilt(design):
        files = real(design)
        files["gait.c"] = files["gait.c"].replace(".damping = {NG(", ".damping = {NG(1.001 * ")
        return files

    monkeypatch.setattr(export_formats, "gait_files", spoilt)
    with pytest.raises(MismatchError, match=r"disagree"):
        export_controller(trained, tmp_path / "c", states=STATES)
    assert list(tmp_path.iterdir()) == []


def test_c_that_does_not_compile_is_a_mismatch(trained, tmp_path, monkeypatch):
    monkeypatch.setattr(export_formats, "gait_files", lambda design: {"gait.h": "int unused = x;"})
    with pytest.raises(MismatchError, match=r"compiles without warnings"):
        export_controller(trained, tmp_path / "c", states=STATES)
    assert list(tmp_path.iterdir()) == []


def test_a_policy_with_a_kink_is_refused_by_name(trained, tmp_path):
    import equinox as eqx
    import jax

    from neuralgaits.gait import MLPPolicy

    relu = MLPPolicy.init(trained.robot, key=jax.random.key(0), activation="relu")
    gait = eqx.tree_at(lambda g: g.policy, trained.gait, relu)
    run = type(trained)(trained.folder, trained.robot, trained.spec, gait)
    with pytest.raises(SpecError, match=r"cannot trace max .*tanh or softplus"):
        export_controller(run, tmp_path / "c")
    assert list(tmp_path.iterdir()) == []


def test_bad_input_is_one_line(trained, tmp_path):
    with pytest.raises(InputError, match=r"unknown format 'rust'"):
        export_controller(trained, tmp_path / "c", format="rust")
    unfinished = tmp_path / "run"
    unfinished.mkdir()
    (unfinished / "config.json").write_bytes((trained.path / "config.json").read_bytes())
    with pytest.raises(RunError, match=r"expected a finished run"):
        export_controller(unfinished, tmp_path / "c")
