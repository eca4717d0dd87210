"""Dynamics of the robots and the margins of the walking spec, against JAX."""

import jax
import pytest

from neuralgaits.barriers import specs
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.gaits import Gait
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.robots import load_robot


@pytest.fixture(scope="module", params=["amber3m", "amber3m-tail", "rabbit"])
def robot(request):
    """With and without centres of mass on the links' lines."""
    return load_robot(request.param)


def test_dynamics(agree, robot):
    """Mass matrix, bias, energies, feet and centre of mass."""
    agree(
        lambda q, dq: {
            "D": robot.mass_matrix(q),
            "H": robot.bias(q, dq),
            "kinetic": robot.kinetic_energy(q, dq),
            "potential": robot.potential_energy(q),
            "foot": robot.swing_foot(q),
            "com": robot.centre_of_mass(q),
        },
        q=(robot.n,),
        dq=(robot.n,),
    )


def test_impact(agree, robot):
    """The unrolled solve, too; configurations are those of a walk."""
    program = agree(
        lambda q, dq: robot.impact(q, dq)._asdict(), q=(robot.n,), dq=(robot.n,), low=-0.4, high=0.4
    )
    assert len(program.operations) < 130


def test_acceleration_and_contact_force(agree, robot):
    """Forward dynamics with the force that goes with it."""

    def forces(q, dq, torque):
        ddq = robot.acceleration(q, dq, torque)
        return {"ddq": ddq, "force": robot.ground_reaction_force(q, dq, ddq)}

    agree(forces, q=(robot.n,), dq=(robot.n,), torque=(robot.n - 1,), low=-0.5, high=0.5)


def test_walking_spec(agree):
    """All conditions of the default spec in one Program, second derivatives included."""
    robot = load_robot("amber3m")
    spec = specs.walking(robot)
    gait = spec.new_gait(jax.random.key(0), "posture", None)
    assert isinstance(gait, Gait)

    def margins(u):
        return spec.margins(gait, ZeroDynamics(robot, gait.policy), u)

    program = agree(margins, u=(2,), low=0.0, parameters=gait)
    assert len(program.operations) < 600
    assert "policy.network.weights[0]" in program.parameters
    assert program.hash == trace(margins, {"u": (2,)}, parameters=gait).hash
