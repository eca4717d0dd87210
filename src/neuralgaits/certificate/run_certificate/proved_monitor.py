"""The monitor of a run: the sets of its proved levels, as Programs of the robot's state.

Only levels count that the run's own proof file bears out, see `verified_summary`.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Coordinates, Float, ZeroState
from neuralgaits.analysis.run import Run
from neuralgaits.analysis.state_monitor import CommandSpan, StateMonitor, StateSet
from neuralgaits.barriers import Barrier, Gait
from neuralgaits.barriers.quantities import Quantity
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.levels.full_order import membership as full_order
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.levels.walking_set import membership as walking_set
from neuralgaits.certificate.levels.walking_set.margins import barriers
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants, safe_premises
from neuralgaits.certificate.premises import first_missing, proved_bounds
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.certificate.run_certificate.verified_summary import (
    CertificateReading,
    read_certificate,
)
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.commands import LEAN, Pair, place_of
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.gait.zero_coordinates import ZeroCoordinates
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.certified import PROOF
from neuralgaits.records.level_words import DISTURBED_LEVEL, FULL_ORDER_LEVEL, WALKING_SET_LEVEL


def monitor_of(run: Run, certificate: CertificateReading | None = None) -> StateMonitor | None:
    """Return the monitor of a run; None if no level above 1 is proved, or of a believed lean.

    Args:
        run: the run.
        certificate: certificate of the run; read if None.

    Raises: SpecError if the sets cannot be traced.
    """
    reading = certificate or read_certificate(run.folder)
    proof = reading.proof
    summary = reading.summary
    levels = proved_levels(reading)
    if proof is None or summary is None or not levels:
        return None
    if place_of(run.trained.commands, LEAN) is not None:
        # z2 of such a set is that of the robot as it is, which no controller knows.
        return None
    sets, theorems = [], proof.theorems
    walking, full = theorems.walking, theorems.full
    if walking is not None and WALKING_SET_LEVEL in levels:
        sets.append(walking_set_of(run, walking, _unproved(run, proof)))
    above = tuple(level for level in (FULL_ORDER_LEVEL, DISTURBED_LEVEL) if level in levels)
    if full is not None and above:
        sets.append(full_order_set_of(run, full, above))
    if not sets:
        return None
    hold = theorems.parameters[DISTURBED_LEVEL].hold if DISTURBED_LEVEL in levels else 0.0
    return StateMonitor(
        tuple(sets),
        hold_s=hold or None,
        bandwidth=full.bandwidth if full is not None and above else None,
        commands=spans(proof.chart, [command.name for command in run.trained.commands]),
        # Those that were compared with the run's files.
        proof_sha256=str(summary.sha256[PROOF]),
        robot_sha256=proof.robot[1],
    )


def proved_levels(reading: CertificateReading) -> tuple[int, ...]:
    """Return the levels above 1 that a proof file bears out, of all commands or of some."""
    if reading.part is not None:
        return tuple(one.level for one in reading.part.levels if one.proved)
    if reading.summary is None:
        return ()
    return tuple(one.level for one in reading.summary.levels if one.proved)


def spans(chart: Chart, command_names: Sequence[str]) -> tuple[CommandSpan, ...]:
    """Return the ranges of commands on a proof's chart, which may be narrower than the gait's."""
    rows = chart.parameters[: 2 * len(command_names)]
    return tuple(
        CommandSpan(name, after.low, after.high, after.change)
        for name, after in zip(command_names, rows[1::2], strict=True)
    )


def walking_set_of(
    run: Run, walking: WalkingSetConstants, unproved: tuple[Barrier, ...] = ()
) -> StateSet:
    """Return the set T of level 2.

    Args:
        run: the run.
        walking: constants of the set.
        unproved: barriers that are not proved on all of T, for a gait without commands.
    """
    robot, trained = run.robot, run.trained
    coordinates = ZeroCoordinates(robot)

    def of_gait(q: Coordinates, dq: Coordinates) -> dict[str, Array]:
        assert isinstance(trained, Gait)
        zd = ZeroDynamics(robot, trained.policy, *run.residuals)
        z = coordinates.of(q, dq)
        return walking_set.walking_membership(trained, zd, walking, unproved, z)

    def of_step(
        q: Coordinates,
        dq: Coordinates,
        before: Float[Array, " p"],
        after: Float[Array, " p"],
        step: Float[Array, " s"],
    ) -> dict[str, Array]:
        assert isinstance(trained, CommandedGait)
        # The step as the controller has it: its ends come with it, its fences are computed here.
        policy = trained.policy.from_step_parameters(step)
        pair = Pair(*map(trained.policy.scaled, (before, after)))
        gait = Gait(policy, trained.tube.at(pair, exact=True))
        zd = ZeroDynamics(robot, policy, *run.residuals)
        return walking_set.walking_membership(gait, zd, walking, (), coordinates.of(q, dq))

    inputs = {"q": (robot.n,), "dq": (robot.n,)}
    if walking.told:
        step_inputs = ("before", "after")  # Inputs of a set that are commands.
        inputs |= {name: (len(trained.commands),) for name in step_inputs}
        inputs["step"] = (trained.policy.step_size,)
    parameters = {"robot": robot, "gait": trained}
    program = trace(of_step if walking.told else of_gait, inputs, parameters=parameters)
    return StateSet(
        (WALKING_SET_LEVEL,),
        "walking",
        "Margins of the walking set: phases, direction; level between the fences [tube widths].",
        program,
        walking_set.ENDS,
        (*walking_set.WALLS, *_names_of(run, unproved)),
    )


def _names_of(run: Run, barriers: Sequence[Barrier]) -> list[str]:
    """Return a name for every element of these barriers' functions."""
    names = []
    for barrier in barriers:

        def h(z: ZeroState, function: Quantity = barrier.function) -> Array:
            return jnp.ravel(function(run.zero_dynamics.point(z)))

        size = jax.eval_shape(h, np.zeros(2)).size
        name = barrier.name
        names += [name] if size == 1 else [f"{name}[{k}]" for k in range(size)]
    return names


def _unproved(run: Run, proof: Claims) -> tuple[Barrier, ...]:
    """Return the barriers that are not proved on all of the set of level 2.

    Raises: SpecError if there are some and the gait takes commands.
    """
    walking = proof.theorems.walking
    assert walking is not None
    bounds = proved_bounds(proof.statements)
    missing = {p.output for p in safe_premises(walking) if first_missing([p], bounds)}
    unproved = tuple(b for b in barriers(run.spec) if f"set/value {b.name}" in missing)
    if unproved and walking.told:
        raise SpecError(
            f"expected a proof in which {unproved[0].name} is not negative on all of the walking "
            "set, found one that leaves it open: a monitor of commands has no such part of the set"
        )
    return unproved


def full_order_set_of(
    run: Run, full: FullOrderConstants, levels: tuple[int, ...] = (FULL_ORDER_LEVEL,)
) -> StateSet:
    """Return the set D of levels 4 and 5, those of them that are proved.

    Raises: SpecError for flat feet.
    """
    gait = run.trained
    assert isinstance(gait, Gait)
    model = FullOrderModel(run.robot, gait, run.spec)

    def of_state(q: Coordinates, dq: Coordinates) -> dict[str, Array]:
        return full_order.full_order_membership(model, full, q, dq)

    n = run.robot.n
    program = trace(
        of_state, {"q": (n,), "dq": (n,)}, parameters={"robot": run.robot, "gait": gait}
    )
    return StateSet(
        levels,
        "full_order",
        "Margins of the set of full states: phases, direction, foot; 1 - V/R(phase)^2, then "
        "h - t - sigma V of every barrier.",
        program,
        full_order.ENDS,
        full_order.wall_names(full),
    )
