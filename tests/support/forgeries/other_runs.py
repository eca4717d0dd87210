"""Parts of another run: its proof, weights, spec, robot or names under this run's hashes."""

import json
from pathlib import Path

import numpy as np
from safetensors.numpy import load_file, save_file

from support.forgeries.base import LOOSE, NO, REJECTED, About, Answer, Case, Theme, true
from support.forgeries.edits import NOBODY, constant, sha256, spec_file

THEME = Theme("small")
WEIGHTS = "policy.safetensors"
ONLY_ITS_WORD = r"(?im)^.*sha256.*\b(says|said|claims|claimed|not checked|not compared)\b"
"""The hash of weights files is the file's word: without them no checker can compute it."""
LAST_LAYER = "policy.network.weights[2]"


def of_run(
    what: str, run: Answer | None = NO, report: Answer | None = None, about: About = "small"
):
    """A run that is spoilt; its proof is the true one."""
    return THEME.forgery(what, cpp=None, alone=None, run=run, report=report, about=about)


def other_weights(folder: Path) -> None:
    """The weights of a run that was trained a little longer."""
    weights = load_file(folder / WEIGHTS)
    weights[LAST_LAYER] = np.ascontiguousarray(weights[LAST_LAYER] * (1.0 + 1e-9))
    save_file(weights, folder / WEIGHTS)


def recopied(folder: Path, file: str, text: str) -> None:
    """An input of the run changed, and its config too."""
    (folder / file).write_text(text)
    config = json.loads((folder / "config.json").read_text())
    config["copies"][file] = sha256(text.encode())
    (folder / "config.json").write_text(json.dumps(config))


@THEME.forgery("another run's proof with this run's hashes", cpp=true(ONLY_ITS_WORD), alone=LOOSE)
def _(case: Case) -> None:
    constant(case.table, LAST_LAYER, lambda w: w * (1.0 + 1e-9))


@THEME.forgery("another spec's proof with this run's hashes", cpp=LOOSE, alone=LOOSE, about="walk")
def _(case: Case) -> None:
    mine = case.base.proofs["small"]
    case.table |= {name: mine[name] for name in ("robot", "spec", "weights_sha256")}
    case.run = case.base.runs["small"]


@THEME.forgery("another run's level 4 with this run's hashes", cpp=NO, alone=LOOSE, about="full")
def _(case: Case) -> None:
    constant(case.table, LAST_LAYER, lambda w: w * (1.0 + 1e-9))


@THEME.forgery("level 4 of another spec's run", cpp=NO, alone=LOOSE, about="full")
def _(case: Case) -> None:
    mine = case.base.proofs["small"]
    case.table |= {name: mine[name] for name in ("robot", "spec", "weights_sha256")}
    case.run = case.base.runs["small"]


@of_run("another run's weights in the folder", run=REJECTED)
def _(case: Case) -> None:
    other_weights(case.folder())


@THEME.forgery(
    "another run's weights in the folder, and their hash in the file", cpp=LOOSE, alone=LOOSE
)
def _(case: Case) -> None:
    folder = case.folder()
    other_weights(folder)
    case.table["weights_sha256"] = sha256((folder / WEIGHTS).read_bytes())


@of_run("another spec in the folder")
def _(case: Case) -> None:
    (case.folder() / "spec.py").write_text("ends = None\n")


@THEME.forgery("another spec in the folder, its hash in config and file", cpp=LOOSE, alone=LOOSE)
def _(case: Case) -> None:
    """Under the same names the other spec asks more."""
    folder = case.folder()
    text = (folder / "spec.py").read_text().replace("hip_height, 0.5)", "hip_height, 0.9)")
    case.table["spec"]["sha256"] = spec_file(folder, text)


@THEME.forgery("the same, and described in config", cpp=LOOSE, alone=LOOSE)
def _(case: Case) -> None:
    folder = case.folder()
    text = (folder / "spec.py").read_text().replace("hip_height, 0.5)", "hip_height, 0.9)")
    case.table["spec"]["sha256"] = spec_file(folder, text)
    file = folder / "config.json"
    config = json.loads(file.read_text())
    for row in config["described"]["conditions"]:
        if row["name"] == "tall":
            row["quantity"]["bound"] = 0.9
    file.write_text(json.dumps(config))


@of_run("another robot in the folder")
def _(case: Case) -> None:
    folder = case.folder()
    (folder / "robot.xml").write_text(_heavier(folder))


@of_run("another robot in the folder, its hash in config")
def _(case: Case) -> None:
    folder = case.folder()
    recopied(folder, "robot.xml", _heavier(folder))


@THEME.forgery("another robot in the folder, its hash in config and file", cpp=LOOSE, alone=LOOSE)
def _(case: Case) -> None:
    folder = case.folder()
    recopied(folder, "robot.xml", _heavier(folder))
    case.table["robot"]["sha256"] = sha256((folder / "robot.xml").read_bytes())


def _heavier(folder: Path) -> str:
    text = (folder / "robot.xml").read_text()
    assert 'mass="13' in text
    return text.replace('mass="13', 'mass="14')


@of_run("another built-in spec in the config")
def _(case: Case) -> None:
    file = case.folder() / "config.json"
    config = json.loads(file.read_text())
    config["spec"] = "walking"
    file.write_text(json.dumps(config))


@of_run("the walking spec's run, and this proof beside it")
def _(case: Case) -> None:
    case.run = case.base.runs["walk"]


def _header(what: str, change: dict[str, str], cpp: Answer, part: str) -> None:
    @THEME.forgery(what, cpp=cpp, alone=LOOSE)
    def _(case: Case) -> None:
        case.table[part] |= change


_header("the robot's name in the header", {"name": "atlas"}, true("atlas"), "robot")
_header("the spec's name in the header", {"name": "spec.py:safe"}, true("spec.py:safe"), "spec")
_header("the robot's hash in the header", {"sha256": NOBODY}, LOOSE, "robot")
_header("the spec's hash in the header", {"sha256": NOBODY}, LOOSE, "spec")
_header("the robot's hash in capitals", {"sha256": NOBODY.upper()}, LOOSE, "robot")


@THEME.forgery(
    "the hash of other weights in the header", cpp=true(NOBODY[:12], ONLY_ITS_WORD), alone=LOOSE
)
def _(case: Case) -> None:
    case.table["weights_sha256"] = NOBODY


@THEME.forgery("the robot's name in header and model", cpp=true("atlas"), alone=LOOSE)
def _(case: Case) -> None:
    case.table["robot"]["name"] = case.table["model"]["robot"]["name"] = "atlas"


@of_run("the robot's name in the run's config")
def _(case: Case) -> None:
    file = case.folder() / "config.json"
    config = json.loads(file.read_text())
    config["robot"] = "atlas"
    file.write_text(json.dumps(config))
