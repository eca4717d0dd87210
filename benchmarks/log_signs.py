"""Signs of columns: how many wrong ones `fit` refuses, and how many right ones.

Asked: no log with a wrong sign of the pitch or of a hip is read. Simulated walks of the shipped
gait with wrong masses, friction and noise, every second one at 200 rows a second; each is read with
the right signs and with each wrong one.
"""

import os
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from common import show

from neuralgaits import logs
from neuralgaits.analysis.run import open_run
from neuralgaits.errors import InputError
from neuralgaits.workflows.simulate import simulate
from support import own_columns
from support.shipped_run import SHIPPED

WALKS = int(os.environ.get("CASES", "20"))
WRONG = (("imu_pitch",), ("hip_l",), ("hip_r",), ("hip_l", "hip_r"), ("knee_l",), ("knee_r",))
ANGLES = ("imu_pitch", *own_columns.JOINTS.values())


def main() -> None:
    """Print every row."""
    refused = {wrong: 0 for wrong in ((), *WRONG)}
    named = dict(refused)
    with TemporaryDirectory() as name:
        folder = Path(name)
        run = open_run(shutil.copytree(SHIPPED, folder / "run"))
        (folder / "columns.toml").write_text(own_columns.SHORT)
        for walk in range(WALKS):
            own = _walked(folder, run, walk)
            for wrong in refused:
                said = _read(folder, run, own, wrong)
                refused[wrong] += said is not None
                named[wrong] += said is not None and ("sign = " in said)
    for wrong, count in refused.items():
        what = " and ".join(wrong) or "right signs"
        show(f"{what}: refused of {WALKS}", "0" if not wrong else f"{WALKS}", str(count))
        show(f"{what}: sign named", "", str(named[wrong]))


def _walked(folder: Path, run, walk: int) -> dict[str, np.ndarray]:
    """Return the columns of a walk with disturbances of its own."""
    rng = np.random.default_rng(walk)
    changes = {
        "mass_scale": rng.uniform(0.9, 1.1),
        "friction": rng.uniform(0.5, 1.0),
        "joint_friction": rng.uniform(0.0, 0.5),
    }
    log = folder / f"{walk}.csv"
    simulate(run, steps=10, start="region", seed=walk, disturb=changes, log=log)
    read = logs.read(log, run.robot).log
    if walk % 2:
        read = read.only(np.arange(len(read)) % 5 == 0)
    own = own_columns.values(run.robot, read)
    noise = np.rad2deg(rng.uniform(0.0, 2e-3))
    return {
        name: values + (noise * rng.standard_normal(len(values)) if name in ANGLES else 0)
        for name, values in own.items()
    }


def _read(folder: Path, run, own: dict[str, np.ndarray], wrong: tuple[str, ...]) -> str | None:
    """Return the line with which a log is refused; None if it is read."""
    turned = {one: 2.0 * own_columns.OFFSETS.get(one, 0.0) - own[one] for one in wrong}
    path = own_columns.write(folder / "own.csv", own | turned)
    columns, policy = folder / "columns.toml", run.gait.policy
    try:
        logs.read(path, run.robot, columns=columns, policy=policy, mend=True)
    except InputError as error:
        return str(error)
    return None


if __name__ == "__main__":
    main()
