"""Mean speed over the last whole step, which a visitor can compare with a command."""


class StepSpeed:
    """Mean forward speed between the last two touchdowns.

    Attributes:
        steps: touchdowns so far.
        mean: the speed [m/s]; None before the second touchdown.
    """

    def __init__(self) -> None:
        self.steps = 0
        self.mean: float | None = None
        self._last: tuple[float, float] | None = None

    def touch_down(self, steps: int, time: float, place: float) -> None:
        """Take note of a touchdown.

        Args:
            steps: touchdowns so far.
            time: simulated [s].
            place: position of the hip, forward [m].
        """
        self.steps = steps
        if self._last is not None and time > self._last[0] and place > self._last[1]:
            self.mean = (place - self._last[1]) / (time - self._last[0])
        # Where it was put back to the beginning of its ground, the next step counts again.
        self._last = (time, place)
