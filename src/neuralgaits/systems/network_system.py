"""The part of a family that trains networks: how wide they are, and what convergence they get."""

from neuralgaits.errors import InputError
from neuralgaits.systems.family_run import WIDEST_NETWORK, NetworkConfig
from neuralgaits.systems.proved_system import ExportedSystem


class NetworkSystem(ExportedSystem):
    """A system whose controller has networks of one hidden layer.

    Attributes:
        spec_name: name of its spec.
        hidden: usual width of the hidden layers.
        rate: of the convergence that its conditions ask for.
    """

    config = NetworkConfig
    spec_name: str
    hidden: int
    rate: float

    def new_config(
        self, *, seed: int, steps: int | None, hidden: tuple[int, ...] | None
    ) -> NetworkConfig:
        """Return the configuration of a training of a robot that is yet to be read.

        Args:
            seed: of weights and samples.
            steps: gradient steps; the usual number if None.
            hidden: width of the one hidden layer; the usual one if None.

        Raises: InputError on bad settings.
        """
        if hidden is not None and len(hidden) != 1:
            raise InputError(
                f"expected one hidden layer, found {len(hidden)}: give one width, as in --hidden "
                f"{self.hidden}"
            )
        width = self.hidden if hidden is None else hidden[0]
        if not 1 <= width <= WIDEST_NETWORK:
            raise InputError(f"hidden: expected a width from 1 to {WIDEST_NETWORK}, found {width}")
        return NetworkConfig(
            family=self.family.name,
            robot="",
            spec=self.spec_name,
            seed=seed,
            steps=self.steps if steps is None else steps,
            width=width,
            rate=self.rate,
        )
