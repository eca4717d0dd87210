"""FMUs of the controller in the loop with MuJoCo, and their time for a step.

Asked: 200 steps walked with the FMU in the loop, and its torques within 1e-9 N m of those of the
same C without it, which tests/export/test_fmu.py asserts. Environment: STEPS.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np
from common import show, whole

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.simulation.setup.starts import full_states
from neuralgaits.workflows.export import design_of, with_monitor
from support.fmu_host import VERSIONS, FmuPlant, UnpackedFmu, made_fmu
from support.shipped_run import SHIPPED

STEPS = whole("STEPS", 200)
MOST_TICKS = 1000 * STEPS
TIMED = 20_000


def walk(fmu: UnpackedFmu, plant: FmuPlant, *, estimate: bool, late: bool) -> dict[str, object]:
    """Walk until STEPS touchdowns or a fault. Returns: figures of the walk."""
    motors = {f"motor.{name}": 0.0 for name in plant.joints}
    watched = (*motors, "monitor.level2.inside", "touchdown", "fault")
    steps = tick = inside = 0
    fault, peak = 0.0, 0.0
    with fmu.instance(estimate=estimate) as one:
        while steps < STEPS and tick < MOST_TICKS and not fault:
            one.set(plant.reading(rates=not estimate))
            one.step(1e-3 * tick)
            found = {name: float(one.get(name)) for name in watched}
            before, motors = motors, {name: found[name] for name in motors}
            applied = before if late else motors
            plant.drive(lambda joint, applied=applied: applied[f"motor.{joint}"])
            steps, inside = steps + int(found["touchdown"]), inside + int(found[watched[-3]])
            fault, tick = found["fault"], tick + 1
            peak = max(peak, *map(abs, motors.values()))
    x = float(plant.data.qpos[plant.plant.state_map.root[0]])
    return {
        "steps": steps,
        "fault": int(fault),
        "speed [m/s]": round(x / (1e-3 * tick), 3),
        "in the set of level 2 [%]": round(100.0 * inside / tick, 1),
        "peak motor command [N m]": round(peak, 1),
    }


def step_us(fmu: UnpackedFmu, plant: FmuPlant) -> float:
    """Time of one doStep called from Python, estimator and monitor included [us]."""
    with fmu.instance() as one:
        one.set(plant.reading(rates=False) | {f"force.{plant.layout.feet[0]}": 200.0})
        began = perf_counter()
        for tick in range(TIMED):
            one.step(1e-3 * tick)
        spent = perf_counter() - began
        assert one.get("fault") == 0
    return round(1e6 * spent / TIMED, 2)


def main() -> None:
    """Print a row for each walk."""
    run = open_run(SHIPPED)
    certificate = read_certificate(run.folder)
    design, _ = with_monitor(design_of(run, certificate), run, certificate)
    (start,) = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1)
    start = np.asarray(start)
    for version in VERSIONS:
        with TemporaryDirectory() as name:
            folder = Path(name)
            fmu = UnpackedFmu(made_fmu(design, version, folder), folder / "unpacked")
            for estimate in (False, True):
                for late in (False, True):
                    plant = FmuPlant(design, start)
                    row = walk(fmu, plant, estimate=estimate, late=late)
                    sensing = "encoders" if estimate else "measured rates"
                    when = "a tick late" if late else "at once"
                    show(f"FMI {version}, {sensing}, torques {when}", row)
            plant = FmuPlant(design, start)
            show(f"FMI {version}, doStep from Python [us]", step_us(fmu, plant))


if __name__ == "__main__":
    main()
