"""A family of gaits: a commanded policy with the tubes of its commands."""

import equinox as eqx

from neuralgaits.gait.commands import CommandPoint, Commands, Pair, pair_at
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.network import movable
from neuralgaits.gait.policies.commanded import CommandedPolicy
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.tubes import CommandedTube


class CommandedGait(eqx.Module):
    """A family of gaits, one for each pair of commands of a step."""

    policy: CommandedPolicy
    tube: CommandedTube

    @property
    def commands(self) -> Commands:
        """Commands of the gait, latched at each touchdown."""
        return self.policy.commands

    def at(
        self,
        robot: SteppingRobot,
        v: CommandPoint,
        reset_residual: ResetCorrection = None,
        *,
        exact: bool = False,
    ) -> Gait:
        """The gait of one step.

        Args:
            robot: whose impact it is matched to.
            v: point of the commands' axes, see `Command.axes`.
            reset_residual: corrects that impact.
            exact: as in `AbstractPolicy.at`.
        """
        return self.of_pair(robot, pair_at(self.commands, v), reset_residual, exact=exact)

    def of_pair(
        self,
        robot: SteppingRobot,
        pair: Pair,
        reset_residual: ResetCorrection = None,
        *,
        exact: bool = False,
        bounded: bool = False,
    ) -> Gait:
        """The gait of a step with these commands; the rest as in `CommandedPolicy.at`."""
        policy = self.policy.at(robot, pair, reset_residual, exact=exact, bounded=bounded)
        places = Pair(*map(self.policy.scaled, pair))
        tube, then = (self.tube.at(each, exact=exact) for each in (places, places.steady))
        return Gait(policy, tube, then)

    def match_impact(
        self, robot: SteppingRobot, reset_residual: ResetCorrection = None
    ) -> "CommandedGait":
        """The family itself: each of its gaits is matched when it is asked for."""
        del robot, reset_residual
        return self

    def trainable(self) -> "CommandedGait":
        """A tree of booleans: True where training may move a leaf."""
        fences = movable(self.tube, lambda t: (t.lower, t.upper))
        return CommandedGait(self.policy.trainable(), fences)


AnyGait = Gait | CommandedGait
