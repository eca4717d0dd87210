"""Deployment files of `export`: a template beside the controller, and the map of an edited one."""

import shutil

import pytest

from neuralgaits.cli.main import main
from neuralgaits.export import build
from support.shipped_run import SHIPPED


@pytest.fixture(scope="module")
def work(tmp_path_factory):
    """A folder with a copy of the shipped run and an export of it; nothing is compared here."""
    folder = tmp_path_factory.mktemp("work")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "compilers", list)
        patch.chdir(folder)
        shutil.copytree(SHIPPED, "run")
        assert main(["export", "run", "--out", "c"]) == 3
        yield folder


@pytest.fixture(scope="module")
def template(work):
    """Text of the template that it wrote."""
    assert not list(work.rglob("board_*"))
    return (work / "c" / "deploy.template.yaml").read_text()


def test_a_template_is_edited_and_exported(work, template, capfd):
    assert "run: 'run'" in template
    (work / "deploy.yaml").write_text(template.replace("motor: 3", "motor: 7"))
    assert main(["export", "run", "--out", "c2", "--config", "deploy.yaml", "--json"]) == 3
    assert '"deployment_sha256": "' in capfd.readouterr().out
    facts = (work / "c2" / "board_facts.h").read_text()
    assert "#define NG_BOARD_MOTORS 8" in facts
    assert "motor 7: hip_right, sign +1, zero 0 rad, gear 1" in facts
    assert not (work / "c2" / "deploy.template.yaml").exists()


def test_all_mistakes_of_a_file_are_printed_and_nothing_is_written(work, template, capfd):
    wrong = template.replace("motor: 3", "motor: 0").replace("period_s: 0.001", "period_s: 0.01")
    (work / "deploy.yaml").write_text(wrong)
    capfd.readouterr()
    assert main(["export", "run", "--out", "c3", "--config", "deploy.yaml"]) == 2
    lines = capfd.readouterr().err.splitlines()
    assert len(lines) == 2 and all(line.startswith("neuralgaits: deploy.yaml") for line in lines)
    assert not (work / "c3").exists()


@pytest.mark.usefixtures("work")
def test_a_policy_alone_has_no_map(capfd):
    words = ["export", "run", "--out", "c4", "--format", "onnx", "--config", "deploy.yaml"]
    assert main(words) == 2
    assert "--config: expected --format c" in capfd.readouterr().err


def test_a_ros2_package_is_written_with_the_robots_own_map(work, capfd):
    assert main(["export", "run", "--out", "ros2", "--format", "ros2", "--json"]) == 3
    assert '"format": "ros2"' in capfd.readouterr().out
    written = {path.name for path in (work / "ros2").iterdir()}
    assert written >= {"package.xml", "plugin.xml", "CMakeLists.txt", "gait_controller.cpp"}
    assert written >= {"gait.c", "board_facts.c", "monitor_set.c", "deploy.template.yaml"}
    assert "link.c" not in written
    facts = (work / "ros2" / "ros2_facts.h").read_text()
    assert '{"knee_left", "hip_left", "knee_right", "hip_right"}' in facts
    assert "#define NG_ROS2_MONITOR 1" in facts


def test_a_config_in_the_folder_itself_is_kept(work, template):
    (work / "c5").mkdir()
    (work / "c5" / "deploy.template.yaml").write_text(template.replace("motor: 3", "motor: 8"))
    mine = (work / "c5" / "deploy.template.yaml").read_bytes()
    words = ["export", "run", "--out", "c5", "--config", "c5/deploy.template.yaml", "--force"]
    assert main(words) == 3
    assert (work / "c5" / "deploy.template.yaml").read_bytes() == mine
    assert "#define NG_BOARD_MOTORS 9" in (work / "c5" / "board_facts.h").read_text()


def test_an_edited_template_is_kept_and_said(work, template, capfd):
    edited = template.replace("motor: 3", "motor: 8").encode()
    shutil.copytree(work / "c", work / "c6")
    (work / "c6" / "deploy.template.yaml").write_bytes(edited)
    assert main(["export", "run", "--out", "c6", "--force"]) == 3
    assert (work / "c6" / "deploy.template.yaml").read_bytes() == edited
    said = " ".join(capfd.readouterr().out.split())
    assert "c6/deploy.template.yaml was kept: it was edited, or is of another run" in said
    (work / "c6" / "deploy.template.yaml").unlink()
    assert main(["export", "run", "--out", "c6", "--force"]) == 3
    assert (work / "c6" / "deploy.template.yaml").read_text() == template


def test_the_map_of_an_earlier_export_does_not_stay_beside_another_controller(work, capfd):
    shutil.copytree(work / "c", work / "c7")
    (work / "c7" / "board_facts.c").write_text("int of_another_robot;")
    before = (work / "c7" / "gait.c").stat().st_mtime_ns
    assert main(["export", "run", "--out", "c7", "--force"]) == 2
    (line,) = capfd.readouterr().err.splitlines()
    assert "expected no board_facts.c in c7, found that of an export with --config" in line
    assert line.endswith("give --config again, or delete board_facts.c")
    assert (work / "c7" / "gait.c").stat().st_mtime_ns == before
