"""A control law that the package does not have: half of the torques of its PD."""

from neuralgaits.control import AbstractLaw, Pd


class Soft(AbstractLaw):
    """Joint PD with half of its torques."""

    hold_ticks: int = 2
    pd: Pd = Pd()

    def with_gains_for(self, joints):
        return Soft(self.hold_ticks, self.pd.with_gains_for(joints))

    def policy_state(self, z):
        return self.pd.policy_state(z)

    def desired(self, robot, outputs, reading):
        return self.pd.desired(robot, outputs, reading)

    def torque(self, robot, reading, desired):
        return 0.5 * self.pd.torque(robot, reading, desired)
