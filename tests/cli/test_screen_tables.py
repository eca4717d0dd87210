"""No word is broken and no line too long, whatever the width; long tables end in a sentence."""

import shutil
from functools import partial
from pathlib import Path

import pytest
from rich.text import Text

from neuralgaits.cli import (
    brief,
    episodes_screen,
    export_screen,
    learning_screen,
    proof_screen,
    report_verb,
    robot_screen,
    screen,
)
from neuralgaits.cli.brief_check import brief_check
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.screen_tables import ROWS, show_facts, show_sentence, show_table
from neuralgaits.records.certified import CertificateRecord
from neuralgaits.records.checked import ProofCheck
from neuralgaits.records.episode_records import EpisodesSummary
from neuralgaits.records.exported import ControllerExport
from neuralgaits.records.final_boxes import boxes_of_proof
from neuralgaits.records.fitted import FitSummary
from neuralgaits.records.inspected import RobotFacts
from neuralgaits.records.installed import BuiltIn, Machine
from neuralgaits.records.reported import ReportRecord
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.records.trained import TrainingSummary
from neuralgaits.workflows.demo import TOLD
from support.shipped_run import SHIPPED

Captured = pytest.CaptureFixture[str]
Environment = pytest.MonkeyPatch
PATH = "/home/somebody/walking-robots/runs/amber3m/20260101T120000Z-0/certificate/full-order.json"
CONDITIONS = 27


def _entry(k: int, verdict: str = "proved") -> dict:
    point = {"u": [0.5, 0.5], "z": [-0.0123456, 17.1234], "margin": -0.0123}
    return {
        "verdict": verdict,
        "proved_fraction": 1.0 if verdict == "proved" else 0.98765,
        "boxes": 1000 + k,
        "undecided_boxes": 12345,
        "margin": None if verdict == "refuted" else 0.01 * (CONDITIONS - k),
        "counterexample": point if verdict == "refuted" else None,
    }


def _constant(name: str) -> dict:
    return {
        "name": name,
        "value": 0.123456,
        "unit": "rad/rad^2",
        "meaning": "what it stands for, " * 4,
        "side": "most" if name.endswith("radius") else "exact",
    }


LEVEL = {
    "level": 4,
    "verdict": "proved",
    "reason": None,
    "words": ["every trajectory that starts in the set stays in the set between impacts " * 3],
    "constants": [
        *(_constant(name) for name in ("radius", "guard radius")),
        *(_constant(f"barrier-{k}: {name}") for k in range(6) for name in ("sigma", "h(z+)")),
    ],
}
PROOF = {
    "verdict": "proved",
    "level": 4,
    "levels": [LEVEL],
    "boxes": 15703,
    "wall_s": 17.6,
    "proof": PATH,
    "map": PATH,
    "conditions": {f"a-condition-of-the-spec-{k}": _entry(k) for k in range(CONDITIONS)},
}
REFUTED = PROOF | {
    "verdict": "refuted",
    "conditions": PROOF["conditions"] | {"worst": _entry(0, "refuted")},
    "levels": [],
}
UNDECIDED = PROOF | {
    "verdict": "undecided",
    "reason": "the budget of 1 s for the search is spent",
    "levels": [LEVEL | {"verdict": "undecided", "reason": "a constant does not fit"}],
}
WALKED = {
    **{"plant": "amber3m", "controller": "pd", "start": "centre", "seed": 0, "episodes": 3},
    **{"steps_walked": [50, 6, 8], "fell": [False, True, True], "poincare": None, "steps": 50},
    **{"fall_reasons": [None, "hip too low", "hip too low"], "push": 64.0},
    "speed_m_s": 0.7,
}
CHECK = {
    "proof": PATH,
    "run": None,
    "verdict": "proved",
    "reason": None,
    "robot": "amber3m",
    "spec": "walking",
    "weights_sha256": "0123456789abcdef",
    "statements": ["knee: the margin is at least 0.43811547903026754 of its scale 0.5 at every "
                   "phase in [0.0, 1.0] and level in [0.0, 1.0] (region tube)"] * 2
    + ["orbit/inside: the margin is at least 0.16880007440590805"] * 30,
    "levels": [LEVEL],
    "unclaimed": ["a-condition"] * 20,
    "assumptions": ["the model is the rigid-body zero dynamics, " * 4],
    "boxes": 4402,
    "boxes_in_balls": 0,
    "arithmetic": "doubles",
    "wall_s": 13.0,
}  # fmt: skip
TRAINED = {
    "run": PATH,
    "robot": "amber3m",
    "spec": "walking",
    "steps": 400,
    "loss": 0.007855,
    "wall_s": 23.0,
    "compile_s": 18.0,
    "conditions": {
        f"a-condition-of-the-spec-{k}": {
            "mean_violation": 0.01 * k,
            "max_violation": 0.1 * k,
            "min_margin": -0.1 * k,
            "scale": 2.0,
        }
        for k in range(CONDITIONS)
    },
}
ROUND = {
    "round": 10,
    "steps_walked": [3, 200],
    "share_that_walks": 0.5,
    "share_of_speeds": 0.5,
    "speed_range_m_s": [0.35, 0.96],
    "barriers": {"tube": 0.98, "all": 0.9, "conditions": {}},
    "heldout_error": 0.01,
    "nominal_heldout_error": 0.1,
    "binned_floor": None,
    "loss": 0.012345,
    "reason": "logs: expected at least 3 strides that can be learned from, found 1: walk longer",
}
ROUNDS = {
    "robot": "amber3m",
    "plant": None,
    "controller": "pd",
    "logs": PATH,
    "rounds": [ROUND] * 3,
    "figure": PATH,
    "run": PATH,
    "episodes": PATH,
    "diverged": None,
    "waiting_for": PATH,
}
TOUCHDOWN = {"z1_m": 0.00412, "z2_kg_m2_s": 0.512, "output_rad": 0.00712, "rate_rad_s": 0.612}
FIT = {
    "run": PATH,
    "logs": [PATH],
    "residual": PATH,
    "train_error": 0.00412,
    "nominal_train_error": 0.0512,
    "heldout_error": 0.00512,
    "nominal_heldout_error": 0.0412,
    "binned_floor": 0.00612,
    "touchdowns": {"count": 6, "before": TOUCHDOWN, "after": TOUCHDOWN},
    "error_bound": [0.0123, 0.223],
    "bound": [0.0323, 8.53],
    "strides": {"train": 2500, "validation": 600, "heldout": 600},
    "left_out": {"missing values": 12, "outliers": 345, "settling after touchdown": 74000},
    "walked_s": 31.25,
    "wall_s": 17.2,
}
TIMES = {name: {"p50": 1.234, "p99": 12.34} for name in ("policy", "pd", "fblin", "paper")}
BUILD = {
    "precision": "double",
    "compiler": "clang",
    "flags": "-O2 -march=native",
    "agreement": {
        "output": 1.2e-15,
        "rate": 3.4e-15,
        "slope": 3.4e-15,
        "torque": 1.2e-15,
        "absolute": 1e-14,
    },
    "latency_us": TIMES,
}
EXPORT = {
    "run": PATH,
    "format": "c",
    "files": ["gait.c"] * 9,
    "out": PATH,
    "checked": True,
    "states": 101700,
    "builds": [BUILD] * 4,
    "laws": ["pd", "fblin", "paper"],
    "warnings": ["this gait is refuted: knee is broken at z1 = 0.0125 m, z2 = 14.25 kg m^2/s"],
    "limits": {},
    "sizes": {
        "float": {"flash_bytes": 31234, "ram_bytes": 1234, "stack_bytes": 234, "structs": {}}
    },
    "float_bound": {"output": 1.2e-5, "rate": 1.2e-5},
}
REPORT = {
    "run": PATH,
    "report": PATH,
    "figures": ["a"] * 11,
    "bytes": 1_234_567,
    "damaged": {"metrics.csv": "expected the columns step, loss and the like, found others " * 3},
    "missing": [{"what": "level 4", "command": f"neuralgaits certify {PATH} --level 4"}] * 2,
}
READY = {"ok": True, "needed": False, "found": "MUJOCO_GL=default: renders", "fix": None}
DOCTOR = {
    "ok": True,
    "neuralgaits": "0.1",
    **dict.fromkeys(("python", "device", "x64", "opengl", "video"), READY),
    "compiler": {"ok": False, "needed": False, "found": "none", "fix": "apt-get install gcc " * 4},
    **dict.fromkeys(("hzd", "drake", "onnx", "mcap", "deploy", "gym", "ray"), READY),
}
ROBOTS = {
    "robots": [{"name": "amber3m-paper", "about": "nominal model of the paper, without " * 4}],
    "specs": [],
}
INSPECTED = {
    "robot": "walker2d",
    "links": [
        {
            "name": "stance_lower_leg",
            "length_m": 0.557,
            "inertia_kg_m2": 0.2036971,
            "body": "lower_leg_left",
            "mass_kg": 5.94812,
            "centre_of_mass_m": [0.173912, 0.0532411],
        },
        {
            "name": "torso",
            "length_m": None,
            "inertia_kg_m2": 0.07,
            "body": "torso",
            "mass_kg": 3.7,
            "centre_of_mass_m": [0.2, -0.01],
        },
    ],
    "actuators": [
        {
            "joint": "stance_lower_leg_joint",
            "torque_limit_nm": 100.0,
            "lower_rad": 0.0,
            "upper_rad": 2.618,
            "armature_kg_m2": 0.01,
            "damping_nms_rad": 0.1,
            "file_joint": "lower_leg_joint_left",
            "file_motor": "lower_leg_motor_left",
        }
    ],
    "coordinates": ["stance_lower_leg", "stance_knee"],
    "mass_kg": 23.7,
    "underactuation": 1,
    "torso": "torso",
    "stance_foot": "foot_point",
    "swing_foot": "foot_left_point",
    "hip_height_m": 1.007,
    "foot_radius_m": 0.003,
    "friction": 1.9,
    "gravity_m_s2": 9.81,
    "written": PATH,
    "changes": ["ankle foot_joint: removed, flat foot foot is welded to leg, " * 3],
}
SCREENS = {
    "proof": (proof_screen.show_proof, CertificateRecord.of(PROOF)),
    "check": (proof_screen.show_check, ProofCheck.of(CHECK)),
    "training": (screen.show_training, TrainingSummary.of(TRAINED)),
    "episodes": (episodes_screen.show_episodes, EpisodesSummary.of(ROUNDS)),
    "fit": (learning_screen.show_fit, FitSummary.of(FIT)),
    "export": (export_screen.show_export, ControllerExport.of(EXPORT)),
    "report": (report_verb.show_report, ReportRecord.of(REPORT)),
    "doctor": (robot_screen.show_findings, Machine.of(DOCTOR)),
    "robots": (robot_screen.show_names, BuiltIn.of(ROBOTS)),
    "robot-file": (robot_screen.show_written, BuiltIn.of({**ROBOTS, "written": PATH})),
    "inspect": (
        partial(robot_screen.show_inspected, robot="mine.xml"),
        RobotFacts.of(INSPECTED),
    ),
    "planarise": (robot_screen.show_planarised, RobotFacts.of(INSPECTED)),
}
BRIEF = {
    "proof": (brief.brief_proof, CertificateRecord.of(PROOF)),
    "proof that is refuted": (brief.brief_proof, CertificateRecord.of(REFUTED)),
    "proof that is undecided": (brief.brief_proof, CertificateRecord.of(UNDECIDED)),
    "check": (brief_check, ProofCheck.of(CHECK)),
    "training": (brief.brief_training, TrainingSummary.of(TRAINED | {"conditions": {}})),
    "fit": (brief.brief_fit, FitSummary.of(FIT)),
    "report": (brief.brief_report, ReportRecord.of(REPORT)),
    "walks": (brief.brief_walks, SimulationSummary.of(WALKED)),
}
SCREENS |= {f"brief {name}": shown for name, shown in BRIEF.items()}
MOST_LINES = 6


@pytest.mark.parametrize("name", BRIEF)
def test_a_command_ends_with_at_most_six_lines(
    name: str, capsys: Captured, monkeypatch: Environment
) -> None:
    out = _shown(f"brief {name}", 2000, capsys, monkeypatch)
    assert 2 <= len(out.splitlines()) <= MOST_LINES


def test_what_is_refuted_is_shown_with_its_state(
    capsys: Captured, monkeypatch: Environment
) -> None:
    lines = _shown("brief proof that is refuted", 2000, capsys, monkeypatch).splitlines()
    assert lines[0].startswith("refuted at level 1")
    assert any(line.startswith("broken") and "z = (" in line for line in lines)
    # Its run is not there: the advice is general.
    assert lines[-1].split(maxsplit=1) == ["next", "neuralgaits train ROBOT --certify"]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "certify runs/a --level 2 --resume"),
        (
            {"parameters": {"mass": 0.02}},
            "certify runs/a --level 2 --parameters mass=0.02 --resume",
        ),
        (
            {"within": {"speed": [0.6, 0.7]}},
            "certify runs/a --level 2 --within speed=0.6:0.7 ",
        ),
        # Boxes are not what is missing.
        ({"conditions": {}}, "report runs/a"),
    ],
)
def test_an_undecided_search_goes_on_with_what_it_was_asked(
    changes: dict, words: str, capsys: Captured, monkeypatch: Environment
) -> None:
    monkeypatch.setenv("COLUMNS", "2000")
    result = UNDECIDED | {"run": "runs/a", "level": 2, "levels": []}
    result["conditions"] = {"open": _entry(0, "undecided")}
    brief.brief_proof(CertificateRecord.of(result | changes))
    assert f"neuralgaits {words}" in capsys.readouterr().out.splitlines()[-1]


@pytest.mark.parametrize("name", [*BRIEF, "export"])
def test_a_command_ends_with_the_next_to_give(
    name: str, capsys: Captured, monkeypatch: Environment
) -> None:
    name = f"brief {name}" if name in BRIEF else name
    last = _shown(name, 2000, capsys, monkeypatch).splitlines()[-1]
    assert last.split()[:2] == ["next", "neuralgaits"]


@pytest.mark.parametrize(
    ("run", "verdict", "ending"),
    [
        (None, "consistent", f"check-proof {PATH} --run RUN"),
        ("runs/a", "proved", "export runs/a --out build/c"),
        ("runs/a", "rejected", "certify runs/a"),
    ],
)
def test_a_checked_proof_is_used_and_another_looked_for(
    run: str | None, verdict: str, ending: str, capsys: Captured, monkeypatch: Environment
) -> None:
    monkeypatch.setenv("COLUMNS", "2000")
    brief_check(ProofCheck.of(CHECK | {"run": run, "verdict": verdict}))
    assert capsys.readouterr().out.endswith(f"neuralgaits {ending}\n")


REASONS = (
    "the proof is about robot 'amber3m', the run about 'heron'",
    f"robot.xml: the run has sha256 {'0f' * 32}, the proof {'1e' * 32}",
    "policy.network.weights[2]: the Program's numbers are not those of a; b.safetensors",
)


def test_a_proof_of_another_run_is_refused_in_one_line(
    capsys: Captured, monkeypatch: Environment
) -> None:
    """The first reason, names before hashes; -v lists all of them, and so does --json."""
    monkeypatch.setenv("COLUMNS", "2000")
    table = CHECK | {"run": "runs/a", "verdict": "rejected", "boxes": 0}
    result = ProofCheck.of(table | {"reason": "; ".join(REASONS), "reasons": [*REASONS]})
    brief_check(result)
    first, *_ = capsys.readouterr().out.splitlines()
    assert first == f"rejected: {REASONS[0]}; 2 more reasons, -v prints all"
    proof_screen.show_check(result)
    assert capsys.readouterr().out.splitlines()[1:4] == [f"  {reason}" for reason in REASONS]
    # One reason is one, whatever signs are in it.
    brief_check(ProofCheck.of(table | {"reason": REASONS[2]}))
    first, *_ = capsys.readouterr().out.splitlines()
    assert first == f"rejected: {REASONS[2]}"
    brief_check(ProofCheck.of(table | {"reason": REASONS[1]}))
    first, *_ = capsys.readouterr().out.splitlines()
    assert first == (
        "rejected: robot.xml: the run has sha256 0f0f0f0f0f0f..., the proof 1e1e1e1e1e1e..."
    )


def test_after_a_proof_of_another_run_the_runs_own_is_checked(
    tmp_path: Path, capsys: Captured, monkeypatch: Environment
) -> None:
    """If it has one; a run whose own proof was refused is proved again."""
    monkeypatch.setenv("COLUMNS", "2000")
    run = shutil.copytree(SHIPPED, tmp_path / "run")
    table = CHECK | {"run": str(run), "verdict": "rejected", "reason": REASONS[0]}
    for proof, ending in (
        (PATH, f"check-proof {run} --run {run}"),
        (str(run / "certificate" / "proof.json"), f"certify {run}"),
    ):
        brief_check(ProofCheck.of(table | {"proof": proof}))
        assert capsys.readouterr().out.endswith(f"neuralgaits {ending}\n")


@pytest.mark.parametrize("name", ["proof", "check", "training", "fit", "report"])
def test_verbose_adds_to_the_short_screen(
    name: str, capsys: Captured, monkeypatch: Environment
) -> None:
    """Every line of it stays, but for where the rest is; it comes last."""
    short, result = BRIEF[name]
    whole, _ = SCREENS[name]
    outcome = Outcome(result, True, whole, brief=short)
    monkeypatch.setenv("COLUMNS", "2000")
    outcome.show()
    lines = capsys.readouterr().out.splitlines()
    outcome.show(verbose=True)
    more = capsys.readouterr().out
    assert "-v " not in more
    ends = more.splitlines()[-len(lines) :]
    assert len(more.splitlines()) > len(lines)
    for line, end in zip(lines, ends, strict=True):
        assert end.startswith(line.partition("; -v ")[0].partition("things")[0])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {},
            "level 5: nothing is proved of these laws; a proof of levels 1 to 4 is about",
        ),
        (
            {
                "law_proofs": [
                    {"law": "fblin", "bandwidth": 30.0, "subject": "fblin", "hold_s": 0.001111}
                    | {"clock": "touchdown", "reason": None}
                ]
            },
            "level 5 of fblin at 30 rad/s: proved for ticks at most 1.111 ms apart",
        ),
    ],
)
def test_an_export_says_what_is_proved_of_its_law(
    changes: dict, words: str, capsys: Captured, monkeypatch: Environment
) -> None:
    monkeypatch.setenv("COLUMNS", "2000")
    export_screen.show_export(ControllerExport.of(EXPORT | changes))
    out = capsys.readouterr().out
    assert words in out and out.count("level 5") == 1
    assert f"next  neuralgaits simulate {PATH} --controller c" in out


def test_an_export_names_the_proof_that_its_run_can_have(
    capsys: Captured, monkeypatch: Environment
) -> None:
    monkeypatch.setenv("COLUMNS", "2000")
    export_screen.show_export(ControllerExport.of(EXPORT | {"run": str(SHIPPED)}))
    assert f"`neuralgaits certify {SHIPPED} --level 5 --bandwidth 50`" in capsys.readouterr().out
    # Level 5 is about one gait: with commands there is none to look for.
    export_screen.show_export(ControllerExport.of(EXPORT | {"run": str(TOLD)}))
    assert "certify" not in capsys.readouterr().out


def test_who_wants_little_room_gets_it(capsys: Captured, monkeypatch: Environment) -> None:
    """A long cell of another column takes no room from a short one, nor an empty column."""
    monkeypatch.setenv("COLUMNS", "60")
    rows = [("double, gcc -O2", "a sentence that is far too long for its column " * 3, "")]
    show_table(("build", "about", "fix"), rows)
    assert "double, gcc -O2  a sentence" in capsys.readouterr().out
    monkeypatch.setenv("COLUMNS", "80")
    export_screen.show_export(ControllerExport.of(EXPORT))
    out = capsys.readouterr().out
    assert out.count("double, clang -O2") == 4 and "µs" in out and " us" not in out


def test_a_proof_at_full_order_is_shown_with_the_control_law_that_it_is_about(
    capsys: Captured,
) -> None:
    levels = [LEVEL | {"level": level} for level in (2, 3, 4)]
    brief.brief_proof(CertificateRecord.of(PROOF | {"levels": levels}))
    assert "under exact linearisation in continuous time" in " ".join(
        capsys.readouterr().out.split()
    )


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({}, "fblin at 50 rad/s: proved for ticks at most 1.75 ms apart, one of them at each"),
        ({"rest": 0.02}, "scheduled-pd at 50 rad/s: proved for ticks at most 1.75 ms apart"),
        ({"kick": 42.0}, "at most 1.75 ms apart, wherever touchdowns lie"),
    ],
)
def test_a_proof_of_held_torques_is_shown_with_its_law_and_ticks(
    more: dict[str, float], words: str, capsys: Captured
) -> None:
    levels = [LEVEL | {"level": level, "figures": {"w": 50.0}} for level in (2, 3, 4)]
    held = LEVEL | {"level": 5, "figures": {"push": 0.9, "hold": 0.00175} | more}
    brief.brief_proof(CertificateRecord.of(PROOF | {"levels": [*levels, held]}))
    out = " ".join(capsys.readouterr().out.split())
    assert words in out.split(" law ")[1]
    # Level 5 (a) alone is of no held torque.
    alone = held | {"figures": {"push": 0.9}}
    brief.brief_proof(CertificateRecord.of(PROOF | {"levels": [*levels, alone]}))
    assert " law " not in capsys.readouterr().out


def _shown(name: str, columns: int, capsys: Captured, monkeypatch: Environment) -> str:
    monkeypatch.setenv("COLUMNS", str(columns))
    show, result = SCREENS[name]
    show(result)
    return capsys.readouterr().out


@pytest.mark.parametrize("name", SCREENS)
def test_80_columns_hold_every_word(name: str, capsys: Captured, monkeypatch: Environment) -> None:
    """The same words as on a screen without an edge, and lines that fit or are one word."""
    narrow = _shown(name, 80, capsys, monkeypatch)
    wide = _shown(name, 2000, capsys, monkeypatch)
    assert sorted(narrow.split()) == sorted(wide.split())
    # A path does not fit; it stands on a line of its own, with its label if that came first.
    assert all(len(line) <= 80 or PATH in line for line in narrow.splitlines())


@pytest.mark.parametrize("name", SCREENS)
def test_40_columns_break_no_word(name: str, capsys: Captured, monkeypatch: Environment) -> None:
    """Tables that do not fit become lists, in which the heads come again."""
    narrow = {word.rstrip(":") for word in _shown(name, 40, capsys, monkeypatch).split()}
    wide = {word.rstrip(":") for word in _shown(name, 2000, capsys, monkeypatch).split()}
    assert narrow == wide


def test_what_is_urgent_stands_first_and_the_rest_is_a_sentence(
    capsys: Captured, monkeypatch: Environment
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    conditions = dict(PROOF["conditions"])
    conditions |= {"worst": _entry(0, "refuted"), "open": _entry(0, "undecided")}
    proof_screen.show_proof(CertificateRecord.of(PROOF | {"conditions": conditions, "levels": []}))
    lines = capsys.readouterr().out.splitlines()
    assert {lines[1].split()[0], lines[2].split()[0]} == {"worst", "open"}
    # By margin: condition 26 has the smallest.
    assert [line.split()[0] for line in lines[3 : ROWS + 1]] == [
        f"a-condition-of-the-spec-{k}" for k in range(CONDITIONS - 1, CONDITIONS - ROWS + 1, -1)
    ]
    # 27 + 2 conditions, 12 shown: of the other 17 the smallest margin is that of condition 16.
    assert "17 more" in lines[ROWS + 1] and "margins of 0.11 or more" in lines[ROWS + 1]


def test_open_conditions_are_never_counted_as_proved(capsys: Captured) -> None:
    conditions = {f"c{k}": _entry(k, "undecided") for k in range(20)} | {"p": _entry(0)}
    proof_screen.show_proof(CertificateRecord.of(PROOF | {"conditions": conditions, "levels": []}))
    assert "and 9 more, 8 of them not proved; --json has all" in capsys.readouterr().out


def test_violations_left_out_are_smaller(capsys: Captured) -> None:
    screen.show_training(TrainingSummary.of(TRAINED))
    out = capsys.readouterr().out
    # Condition 0 is not broken; 26 down to 15 are shown; 14 is the worst of the rest.
    assert "the gait failed: 26 of 27 conditions do not hold" in out
    assert "and 14 more, by 1.4 at most" in out


def test_a_sentence_hangs(capsys: Captured, monkeypatch: Environment) -> None:
    monkeypatch.setenv("COLUMNS", "20")
    show_sentence(Text("proved", "green"), " at level one of four", indent=2, hang=2)
    assert capsys.readouterr().out == "  proved at level\n    one of four\n"
    show_facts([("run", "a-path-of-more-than-20-columns"), ("", "x")])
    assert capsys.readouterr().out == "run\n     a-path-of-more-than-20-columns\n     x\n"


def test_a_table_without_rows_is_nothing(capsys: Captured) -> None:
    show_table(("a", "b"), [])
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("needed", "last"),
    [
        (False, "everything needed is there; 1 optional part missing"),
        (True, "missing: compiler"),
    ],
)
def test_doctor_ends_with_one_line_that_sums_up(
    needed: bool, last: str, capsys: Captured, monkeypatch: Environment
) -> None:
    compiler = DOCTOR["compiler"] | {"needed": needed}
    robot_screen.show_findings(Machine.of(DOCTOR | {"compiler": compiler}))
    assert capsys.readouterr().out.splitlines()[-1] == last


def test_a_column_without_content_takes_no_room(capsys: Captured, monkeypatch: Environment) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    found = "cpu (cpu), 2 cores, jax 0.10.2, ready for all"
    show_table(("what", "found", "a remedy"), [("jax", found, "")])
    head, row = capsys.readouterr().out.splitlines()
    assert head.split() == ["what", "found"]
    assert row.split(maxsplit=1) == ["jax", found]


def test_each_number_of_boxes_says_which_it_is(capsys: Captured, monkeypatch: Environment) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    proof = SHIPPED / "certificate" / "proof.json"
    brief.brief_proof(CertificateRecord.of(PROOF | {"proof": str(proof)}))
    count = boxes_of_proof(proof)
    assert f"{count} in the proof file (15703 bounded in the search)" in capsys.readouterr().out
    brief_check(ProofCheck.of(CHECK))
    assert "4402 bounded in the check" in capsys.readouterr().out
