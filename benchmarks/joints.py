"""Friction and rotors from logs: how far off they are, and what a controller gains by them.

Asked: 1 N m of dry friction and rotors 20 % heavier, unknown to the controller, identified to 10 %
from 30 s of log; half the error of the outputs once the controller knows. Printed beside that: logs
of encoders, slow logs, other friction, and masses that the model has wrong, which nothing asks for.
"""

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from common import show

from neuralgaits import logs
from neuralgaits.records.identified_joints import Estimate, IdentifiedJoints
from neuralgaits.robots import load_robot
from neuralgaits.workflows.fit_joints import fit_joints
from neuralgaits.workflows.simulate import simulate
from support import rubbing_walk
from support.shipped_run import SHIPPED

STEPS = 62
"""Of a walk: 30 s."""
ROTOR = rubbing_walk.ROTOR_SHARE * float(load_robot("amber3m").armature[1])


def main() -> None:
    """Print every row."""
    with TemporaryDirectory() as folder:
        run = shutil.copytree(SHIPPED, Path(folder) / "run")
        walk = _walked(run, "perfect")
        _errors("perfect sensing, 1 kHz", fit_joints(run, [walk]), "10 %")
        _gain(run, walk)
        for rate in (200, 100):
            slow = walk.with_stem(f"every-{rate}")
            rows = walk.read_text().splitlines()
            slow.write_text("\n".join([rows[0], *rows[1 :: 1000 // rate]]) + "\n")
            _errors(f"every row of {rate} Hz", fit_joints(run, [slow]))
        starts = _walked(run, "region", start="region", seed=1)
        _errors("from a random state", fit_joints(run, [starts]))
        encoders = _walked(run, "encoders", sensing="encoders")
        _errors("encoders, 2 ms late", fit_joints(run, [encoders]))
        for friction in (0.2, 3.0):
            other = _walked(run, f"friction-{friction}", disturb={"joint_friction": friction})
            _errors(f"friction {friction:g} N m", fit_joints(run, [other]), friction=friction)
        heavy = {"joint_friction": 1.0, "mass_scale": 1.05}
        _errors("masses 5 % heavier", fit_joints(run, [_walked(run, "heavy", disturb=heavy)]))


def _walked(run: Path, name: str, **others: Any) -> Path:
    """Walk on the plant with friction and heavier rotors. Returns: the log."""
    log = run.parent / f"{name}.csv"
    disturb = {"joint_friction": rubbing_walk.FRICTION_NM}
    given: dict[str, Any] = {
        "plant": rubbing_walk.heavier(),
        "disturb": disturb,
        "steps": STEPS,
    } | others
    simulate(run, log=log, **given)
    return log


def _errors(
    what: str, found: IdentifiedJoints, asked: str = "", friction: float = rubbing_walk.FRICTION_NM
) -> None:
    """Print the largest error of each kind of number, and how many intervals hold the truth."""
    quantities = (("friction_nm", friction), ("armature_kg_m2", ROTOR), ("damping_nms_rad", 0.0))
    held = []
    for name, truth in quantities:
        estimates: list[Estimate] = [getattr(joint, name) for joint in found.joints]
        held += [one.low <= truth <= one.high for one in estimates]
        worst = max(abs(one.value - truth) for one in estimates)
        if truth:
            show(f"{what}: {name}, largest error", f"{100.0 * worst / truth:.2g} %", asked)
        else:
            show(f"{what}: {name}, largest error", f"{worst:.2g} N m s/rad")
    show(f"{what}: intervals that hold the truth", f"{sum(held)} of {len(held)}")


def _gain(run: Path, before: Path) -> None:
    """Print errors of the outputs without and with the joints that were identified."""
    rms, largest = _output_errors(before)
    show("output error without, rms [mrad]", 1e3 * rms)
    show("output error without, largest [mrad]", 1e3 * largest)
    for controller in ("pd", "fblin"):
        after = _walked(run, f"known-{controller}", joints="latest", controller=controller)
        rms, largest = _output_errors(after)
        asked = "half" if controller == "pd" else ""
        show(f"output error with, {controller}, rms [mrad]", 1e3 * rms, asked)
        show(f"output error with, {controller}, largest [mrad]", 1e3 * largest, asked)
    alone = _walked(run, "fblin", controller="fblin")
    rms, largest = _output_errors(alone)
    show("output error without, fblin, rms [mrad]", 1e3 * rms)
    show("output error without, fblin, largest [mrad]", 1e3 * largest)
    model = _walked(run, "model", plant=None, disturb=None)
    rms, largest = _output_errors(model)
    show("output error where the plant is the model, rms [mrad]", 1e3 * rms)
    show("output error where the plant is the model, largest [mrad]", 1e3 * largest)


def _output_errors(log: Path) -> tuple[float, float]:
    """Return rms and largest error after the start and from 20 ms after touchdowns (rad)."""
    robot = load_robot("amber3m")
    walked = logs.read(log, robot).log
    strides = logs.cut([walked], robot).strides[2:]
    rows = np.concatenate([np.searchsorted(walked.t, stride.t) for stride in strides])
    error = np.abs(walked.q[rows, 1:] - walked.qd[rows])
    return float(np.sqrt(np.mean(error**2))), float(error.max())


if __name__ == "__main__":
    main()
