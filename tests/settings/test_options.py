"""A setting is written once: command line, Python call and printed command follow."""

import inspect
import math
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pytest
import tyro

import neuralgaits
from neuralgaits import settings as of
from neuralgaits._called_with import called_with, descriptions
from neuralgaits.cli.argv_parser import _VERBS, given, read
from neuralgaits.errors import InputError
from neuralgaits.settings.options import arg, marks_of, words_of

CALLED: dict[str, tuple[str, type]] = {
    "train": ("train", of.TrainSettings),
    "optimise": ("optimise", of.OptimiseSettings),
    "import-gait": ("import_gait", of.ImportGaitSettings),
    "simulate": ("simulate", of.SimulateSettings),
    "certify": ("certify", of.CertifySettings),
    "check-proof": ("check_proof", of.CheckProofSettings),
    "check-deploy": ("check_deploy", of.CheckDeploySettings),
    "fit": ("fit", of.FitSettings),
    "refine": ("refine", of.RefineSettings),
    "episodes": ("episodes", of.EpisodesSettings),
    "sweep": ("sweep", of.SweepSettings),
}
ANY: Any = neuralgaits
OF_ANOTHER_CALL = {"train": {"seeds"}, "fit": {"joints", "write"}}
"""Options of a verb that another Python call has: `train_seeds`, `fit_joints`."""
WALKED = of.SimulateSettings(
    "a run",
    plant="my robot.xml",
    controller="fblin",
    steps=7,
    push=-1.5,
    disturb="friction=0.4",
    parameters={"mass": 0.1 / 3.0, "floor": 0.005},
    command="speed=0.7",
    terrain="stones,width=0.1",
    log=Path("walk.csv"),
    workers=2,
)
TOLD: tuple[tuple[str, Any], ...] = (
    (
        "train",
        of.TrainSettings("amber3m", "rugged", seed=3, hidden=(8, 4), certify=True, budget=2.5),
    ),
    ("train", of.TrainSettings("amber3m", speed=0.1 / 0.3, slope=(-math.radians(5.0), 0.1))),
    ("train", of.TrainSettings("amber3m", speed=(0.6, 0.8), step_height=(-0.02, 0.02))),
    ("train", of.TrainSettings(resume="latest")),
    ("simulate", WALKED),
    ("certify", of.CertifySettings("latest", level=5, bandwidth=50.0, error=0.05)),
    ("certify", of.CertifySettings("latest", disturbance=(0.01, 0.3), parameters={}, resume=True)),
    ("certify", of.CertifySettings("r", disturbance="learned", within={"speed": (0.7, 0.72)})),
    ("certify", of.CertifySettings("r", level=5, state_error=(5.1e-6, 0.1 / 3.0))),
    ("check-proof", of.CheckProofSettings(Path("a b.json"), run="latest")),
    (
        "check-deploy",
        of.CheckDeploySettings(Path("deploy.yaml"), Path("a b.csv"), run="r", rehearse=True),
    ),
    ("fit", of.FitSettings("latest", (Path("a.csv"), Path("b c.csv")), optimizer="nero")),
    ("refine", of.RefineSettings("latest", residual=Path("r.safetensors"), steps=5)),
    ("episodes", of.EpisodesSettings("amber3m", plant="rabbit", rounds=1, controller="fblin")),
    ("sweep", of.SweepSettings(("amber3m", "rabbit"), speeds=[0.7, (0.6, 0.8)], seeds=(0, 3))),
    ("optimise", of.OptimiseSettings("amber3m", 0.7, degree=6)),
    ("import-gait", of.ImportGaitSettings(Path("gait.json"), "rabbit", name="slow")),
)


@pytest.mark.parametrize("verb", CALLED)
def test_the_python_call_takes_what_the_command_line_takes(verb: str) -> None:
    function, kind = CALLED[verb]
    called = inspect.signature(getattr(neuralgaits, function)).parameters
    assert list(called) == list(inspect.signature(kind).parameters)
    typed = marks_of(_VERBS[verb])
    assert set(marks_of(kind)) == set(typed) - {"output"} - OF_ANOTHER_CALL.get(verb, set())
    # And says what each is, in the words of the help.
    said = descriptions(kind)
    assert set(said) == set(called)
    doc = " ".join((inspect.getdoc(getattr(neuralgaits, function)) or "").split())
    assert all(text in doc for text in said.values())


@pytest.mark.parametrize(("verb", "settings"), TOLD, ids=[verb for verb, _ in TOLD])
def test_printed_words_are_read_back_exactly(verb: str, settings: Any) -> None:
    typed = read([verb, *words_of(settings)])
    again = type(settings)(**given(typed, type(settings)))
    if getattr(settings, "slope", None):
        # Degrees and back: to the last digit but one.
        assert again.slope == pytest.approx(settings.slope, rel=1e-15)
        again = replace(again, slope=settings.slope)
    assert again == settings


@dataclass(frozen=True)
class Painting:
    """Settings of a verb that nobody has."""

    robot: Annotated[tyro.conf.Positional[str], arg(metavar="ROBOT")]
    """Robot to paint."""
    _: KW_ONLY
    shade: Annotated[int, arg(metavar="N")] = 3
    """Darkness
    of the paint."""

    def __post_init__(self) -> None:
        if self.shade > 9:
            raise InputError(f"expected a shade of at most 9, found {self.shade}")


def test_a_new_option_is_one_field(capsys: pytest.CaptureFixture[str]) -> None:
    @called_with(Painting)
    def paint(settings: Painting) -> str:
        """Paint a robot.

        Returns: colour.
        """
        return f"{settings.robot} in {settings.shade}"

    assert paint("amber3m", shade=4) == "amber3m in 4"
    assert str(inspect.signature(paint)) == "(robot: str, *, shade: int = 3) -> str"
    assert "shade: Darkness of the paint." in str(paint.__doc__)
    assert tyro.cli(Painting, args=words_of(Painting("amber3m", shade=4))).shade == 4
    assert words_of(Painting("amber3m")) == ["amber3m"]
    with pytest.raises(InputError, match="at most 9"):
        tyro.cli(Painting, args=["amber3m", "--shade", "10"])
    with pytest.raises(SystemExit):
        tyro.cli(Painting, args=["--help"])
    assert "--shade N" in capsys.readouterr().out


def test_a_python_caller_may_write_what_the_command_line_reads() -> None:
    taken: list[of.TrainSettings] = []

    @called_with(of.TrainSettings)
    def called(settings: of.TrainSettings) -> None:
        taken.append(settings)

    train: Any = called

    train("amber3m", parameters="mass=2%", hidden="8,8", slope="-5:5", speed="0.6:0.7")
    [found] = taken
    assert (found.robot, found.parameters, found.hidden) == ("amber3m", {"mass": 0.02}, (8, 8))
    assert found.slope == (math.radians(-5.0), math.radians(5.0)) and found.speed == (0.6, 0.7)
    with pytest.raises(InputError, match="LOW:HIGH in degrees, found '5'"):
        train("amber3m", slope="5")
    with pytest.raises(TypeError, match=r"called\(\) got .* 'step'; did you mean steps\?"):
        train("amber3m", step=3)
    shown = str(inspect.signature(neuralgaits.simulate))
    assert shown.startswith(
        "(run: Run | str | Path, *, plant: PlanarBiped | str | Path | None = None"
    )
    assert "controller: str | AbstractLaw = 'pd'" in shown
    assert max(len(line) for line in str(neuralgaits.simulate.__doc__).splitlines()) <= 100


ENDLESS = 10**5000
"""A whole number that no float holds, and that Python does not write."""


class Unprintable:
    """An object whose own text fails."""

    def __repr__(self) -> str:
        raise ValueError("no text")


@pytest.mark.parametrize(
    ("call", "found"),
    [
        (lambda: ANY.train(3), "a robot by name, by path .* found 3"),
        (lambda: ANY.train("amber3m", 3), "spec: expected .* found 3"),
        (lambda: ANY.train("amber3m", seed=True), "seed: expected int, found True"),
        (lambda: ANY.train("amber3m", steps=1.5), "steps: expected int, found 1.5"),
        (lambda: ANY.train("amber3m", speed=(1, 2, 3)), "speed: expected float"),
        (lambda: ANY.train("amber3m", certify="yes"), "certify: expected bool"),
        (lambda: ANY.train("amber3m", hidden=(32.5,)), "hidden: expected tuple"),
        (lambda: ANY.train("amber3m", out=3), "out: expected str . Path"),
        (lambda: ANY.simulate(None), "a run, its folder or .latest., found None"),
        (lambda: ANY.simulate("r", push="3"), "push: expected float, found '3'"),
        (lambda: ANY.simulate("r", command=3), "command: expected str . Mapping"),
        (lambda: ANY.certify("r", level="3"), "level: expected int, found '3'"),
        (lambda: ANY.certify("r", level=2.0), "level: expected int, found 2.0"),
        (lambda: ANY.certify("r", disturbance=(1,)), "disturbance: expected tuple"),
        (lambda: ANY.certify("r", within={"speed": 1}), "within: expected Mapping"),
        (lambda: ANY.certify("r", within=[]), "within: expected Mapping"),
        (lambda: ANY.fit("r", "walk.csv"), "logs: expected"),
        (lambda: ANY.sweep("amber3m"), "robots: expected"),
        (lambda: ANY.sweep(["amber3m"], seeds=(0,)), "seeds: expected tuple"),
        (
            lambda: ANY.sweep(["amber3m"], walks=10**400),
            "walks: .* 308 digits, found a number of 401",
        ),
        (lambda: ANY.train_seeds("amber3m", seeds=3), "seeds: expected tuple"),
        (lambda: ANY.open_run(3), "a run, its folder"),
        (lambda: ANY.open_run(ENDLESS), "its folder or `latest`, found a number of 5001 digits"),
        (lambda: ANY.open_run("x" * 300), "found a name of 300 bytes"),
        (lambda: ANY.open_run(Unprintable()), "`latest`, found an object of type Unprintable"),
        (lambda: ANY.load_robot(ENDLESS), "found a number of 5001 digits"),
        (lambda: ANY.load_robot(Unprintable()), "found an object of type Unprintable"),
        (lambda: ANY.figures(ENDLESS), "run: expected .*, found a number of 5001 digits"),
        (lambda: ANY.train("amber3m", speed=ENDLESS), "speed: expected .* 5001 digits"),
        (lambda: ANY.train("amber3m", progress=3), "progress: expected Callable.*, found 3"),
        (lambda: ANY.train("amber3m", watch=3), "watch: expected Watch .* None, found 3"),
        (lambda: ANY.train("amber3m", root=3), "root: expected Path, found 3"),
        (lambda: ANY.certify("r", progress=3), "progress: expected Callable.*, found 3"),
        (lambda: ANY.certify("r", level=-ENDLESS), "level: expected .* 5001 digits"),
        (lambda: ANY.certify("r", level=Unprintable()), "expected int, found an object of type"),
        (lambda: ANY.certify("r", disturbance=(ENDLESS, 1.0)), "disturbance: .* 5001 digits"),
        (lambda: ANY.certify("r", parameters={"mass": ENDLESS}), "parameters: .* 5001 digits"),
        (lambda: ANY.simulate("r", push=10**400), "push: expected .* a number of 401 digits"),
        (lambda: ANY.simulate("r", disturb={"friction": 10**400}), "disturb: .* 401 digits"),
        (lambda: ANY.simulate("r", log="a\0b"), "log as str . Path . None, found a name .* NUL"),
        (lambda: ANY.fit("r", [None]), "logs as Sequence.* found None"),
        (lambda: ANY.sweep(["amber3m"], speeds=[True]), "speeds: expected"),
        (lambda: ANY.export_controller("r", None), "out: expected str . Path, found None"),
        (lambda: ANY.export_controller("r", "x", states=0), "states: expected 1 or more"),
        (lambda: ANY.export_controller("r", "a\0b"), "out as str . Path, found a name .* NUL"),
        (lambda: ANY.view("r", port=True), "port: expected int, found True"),
        (lambda: ANY.view("r", host=5), "host: expected str, found 5"),
        (lambda: ANY.demo(speed=1), "speed: expected bool, found 1"),
        (lambda: ANY.figures(5), "run: expected Run or str or Path, found 5"),
        (lambda: ANY.write_report("r", out=5), "out: expected str or Path, found 5"),
        (lambda: ANY.inspect("amber3m"), "robot: expected a PlanarBiped, found 'amber3m': load"),
        (lambda: ANY.export_controller("r", "x", force="no"), "force: expected bool"),
        (lambda: ANY.load_robot("a" * 9999), "found a name of 9999 characters"),
        (lambda: ANY.load_robot(b"x"), "a robot by name"),
    ],
)
def test_values_of_other_types_are_refused_in_a_line(
    call: Callable[[], Any], found: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=found):
        call()
    assert not list(tmp_path.iterdir())


def test_numpys_numbers_and_lists_are_taken() -> None:
    settings: Any = of
    found = settings.TrainSettings("amber3m", seed=np.int64(3), speed=[0.6, 0.7])
    assert (found.seed, found.speed) == (3, (0.6, 0.7)) and type(found.seed) is int
    assert settings.SimulateSettings("r", push=np.float64(2.0), steps=np.int32(5)).steps == 5
    assert settings.SimulateSettings("r", push=3).push == 3


def test_settings_that_exclude_each_other_are_refused_where_they_are_defined() -> None:
    with pytest.raises(InputError, match="--resume alone, found it with --certify, --budget"):
        of.TrainSettings(resume="latest", certify=True, budget=3.0)
    with pytest.raises(InputError, match="level 4 or 5 with a bandwidth, found 3"):
        of.CertifySettings("latest", bandwidth=20.0)
    with pytest.raises(
        InputError, match="level 5 of fblin with an error of the state, found level 4"
    ):
        of.CertifySettings("latest", level=4, state_error=(1e-6, 1e-4))
    with pytest.raises(InputError, match="found level 5 of scheduled-pd"):
        of.CertifySettings("r", level=5, controller="scheduled-pd", state_error=(1e-6, 1e-4))
    with pytest.raises(InputError, match="errors of angles and rates of more than 0"):
        of.CertifySettings("r", level=5, state_error=(0.0, 1e-4))
    with pytest.raises(InputError, match="level 2 or more with a disturbance"):
        of.CertifySettings("latest", level=1, disturbance="learned")
