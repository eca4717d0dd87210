"""The verb `check-deploy`: exit codes, screens, and logs that are refused in a line."""

import json
import shutil

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.cli.main import main
from neuralgaits.deployment.deployment_template import deployment_text, template
from neuralgaits.deployment.hung_log import hung_log_text, read_hung_log
from neuralgaits.deployment.hung_robot import HungRobotSettings, hung_log
from neuralgaits.errors import InputError, ManyProblems
from neuralgaits.workflows.deployed_run import deployed_robot
from support.shipped_run import SHIPPED

NAMES = ("knee_left", "hip_left", "knee_right", "hip_right", "pitch", "zero")


@pytest.fixture(scope="module")
def work(tmp_path_factory):
    """A folder with a deployment file of the shipped run, and a log of a robot that it fits."""
    folder = tmp_path_factory.mktemp("work")
    run = open_run(SHIPPED)
    file = template(deployed_robot(run), (100.0, 3.0))
    (folder / "deploy.yaml").write_text(deployment_text(file))
    settings = HungRobotSettings(directions=True, zero=True, seconds=1.6)
    (folder / "log.csv").write_text(hung_log_text(hung_log(run.robot.layout, file, 1, settings)))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield folder


@pytest.mark.usefixtures("work")
def test_a_file_that_fits_its_robot(capfd):
    assert main(["check-deploy", "deploy.yaml", "log.csv", "--json"]) == 0
    found = json.loads(capfd.readouterr().out)
    assert found["agrees"] and not found["findings"]
    assert set(found["joints"]) == {"knee_left", "hip_left", "knee_right", "hip_right"}
    assert all(abs(one["zero_error_rad"]) < 0.01 for one in found["joints"].values())


def test_a_file_that_does_not(work, capfd):
    text = (work / "deploy.yaml").read_text()
    (work / "wrong.yaml").write_text(text.replace("    sign: 1", "    sign: -1", 1))
    words = ["check-deploy", "wrong.yaml", "log.csv", "--run", str(SHIPPED)]
    assert main(words) == 1
    assert "differs: log.csv contradicts wrong.yaml" in capfd.readouterr().out
    assert main([*words, "--json"]) == 1
    (found,) = json.loads(capfd.readouterr().out)["findings"]
    assert (found["about"], found["remedy"]) == ("knee_left", "write sign: 1")


def test_a_log_that_says_too_little_is_undecided(work, capfd):
    text = (work / "log.csv").read_text()
    (work / "short.csv").write_text(text.replace(",+hip_left\n", ",\n"))
    assert main(["check-deploy", "deploy.yaml", "short.csv"]) == 3
    out = capfd.readouterr().out
    assert "not checked: motor of hip_left: no row is labelled hip_left" in out


def test_a_contact_that_answers_to_nothing_was_not_checked(work, capfd):
    rows = [line.split(",") for line in (work / "log.csv").read_text().splitlines()]
    before = rows[0].index("pitch[rad]")
    contacts = [["contact_0", "contact_1"], *([["0", "0"]] * (len(rows) - 1))]
    rows = [row[:before] + two + row[before:] for row, two in zip(rows, contacts, strict=True)]
    rows += [[*rows[-1][:-1], "foot_left"] for _ in range(200)]
    for i in range(200):
        rows[-200 + i][0] = repr(float(rows[-201][0]) + 0.002 * (i + 1))
    (work / "dead.csv").write_text("\n".join(map(",".join, rows)))
    # Of the joints it shows all.
    assert main(["check-deploy", "deploy.yaml", "dead.csv"]) == 0
    assert "contact of foot_left: no channel answers to it" in capfd.readouterr().out


def test_a_log_of_less_than_the_filter_is_not_checked_for_torques(work, capfd):
    head, *lines = (work / "log.csv").read_text().splitlines()
    # As a log of 1 kHz, these rows are shorter than what torques are smoothed over.
    rows = [f"{0.001 * i},{line.partition(',')[2]}" for i, line in enumerate(lines[:150])]
    (work / "few.csv").write_text("\n".join([head, *rows]))
    assert main(["check-deploy", "deploy.yaml", "few.csv"]) == 3
    assert "torques: too few rows" in capfd.readouterr().out


def test_a_rehearsal_replaces_no_file_of_a_run(work, capfd):
    inside = shutil.copytree(SHIPPED, work / "run")
    own = inside / "joints" / "joints.json"
    words = ["check-deploy", "deploy.yaml", str(own), "--rehearse", "--run", str(inside)]
    assert main(words) == 2
    assert "joints.json" in capfd.readouterr().err and not own.exists()
    words[2] = str(inside / "hung.csv")
    assert main(words) == 0 and (inside / "hung.csv").exists()
    capfd.readouterr()


def test_a_file_without_a_run_needs_one(work, capfd):
    text = (work / "deploy.yaml").read_text().replace("run: ", "ran: ")
    (work / "without.yaml").write_text(text)
    assert main(["check-deploy", "without.yaml", "log.csv"]) == 2
    assert "expected the key run" in capfd.readouterr().err
    assert main(["check-deploy", "deploy.yaml", "none.csv"]) == 2
    assert capfd.readouterr().err.count("\n") == 1


def test_a_rehearsal_writes_a_log_and_nothing_twice(work, capfd):
    words = ["check-deploy", "deploy.yaml", "rehearsal.csv", "--rehearse"]
    assert main(words) == 0
    before = (work / "rehearsal.csv").read_bytes()
    capfd.readouterr()
    assert main(words) == 2
    assert "--rehearse: expected no file at rehearsal.csv" in capfd.readouterr().err
    assert (work / "rehearsal.csv").read_bytes() == before


def _rows(count: int = 120) -> list[str]:
    head = "t[s],position_0[rad],torque_0[N m],pitch[rad],moved"
    return [head, *(f"{0.01 * i:.2f},0.1,1.0,0.0,hip_left" for i in range(count))]


def test_a_log_is_read_back(work):
    log = read_hung_log(work / "log.csv", NAMES)
    assert log.motors == (0, 1, 2, 3) and log.torque is not None
    assert [name for name, _, _ in log.windows()] == ["zero", *NAMES[:4], "pitch"]
    # An empty label at the end of a line is left out by programs.
    (work / "own.csv").write_text("\n".join([*_rows(), "1.2,0.1,1.0,0.0,", "1.25,0.1,1.0,0.0"]))
    assert read_hung_log(work / "own.csv", NAMES).moved[-2:] == ("", "")


BAD = {
    "a number": (3, "0.02,x,1.0,0.0,hip_left", "row 4, column position_0[rad]: expected a finite"),
    "NaN": (3, "0.02,nan,1.0,0.0,hip_left", "row 4, column position_0[rad]: expected a finite"),
    "far": (3, "0.02,1e99,1.0,0.0,hip_left", "row 4, column position_0[rad]: expected a finite"),
    "long": (120, "9000,0.1,1.0,0.0,hip_left", "and at most 3600 s, found 0.01 s and 9e+03 s"),
    "gap": (120, "1.4,0.1,1.0,0.0,hip_left", "row 121: expected at most 0.1 s from row to row"),
    "width": (3, "0.02,0.1", "row 4: expected 5 columns, found 2"),
    "time": (3, "0.00,0.1,1.0,0.0,hip_left", "row 4: expected times that increase"),
    "label": (3, "0.02,0.1,1.0,0.0,hip_lefd", "moved: expected one of knee_left"),
    "no pitch": (0, "t[s],position_0[rad],torque_0[N m],p,moved", "expected a column pitch[rad]"),
    "no motor": (0, "t[s],a,b,pitch[rad],moved", "expected a column position_I[rad]"),
    "torques": (0, "t[s],position_0[rad],torque_1[N m],pitch[rad],moved", "or for none, found"),
    "twice": (0, "t[s],position_0[rad],position_0[rad],pitch[rad],moved", "each column once"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_log_is_refused(name, tmp_path):
    row, text, said = BAD[name]
    rows = _rows()
    rows[row] = text
    path = tmp_path / "log.csv"
    path.write_text("\n".join(rows))
    with pytest.raises(InputError) as error:
        read_hung_log(path, NAMES)
    found = error.value
    problems = found.problems if isinstance(found, ManyProblems) else (str(found),)
    assert any(said in one for one in problems), problems


def test_a_short_log_is_refused(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("\n".join(_rows(50)))
    with pytest.raises(InputError, match="expected 100 rows or more, found 50"):
        read_hung_log(path, NAMES)
