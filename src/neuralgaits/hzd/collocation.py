"""Global collocation over the phase of a step: nodes, and integrals of values at them."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from neuralgaits._types import Float


class Nodes(NamedTuple):
    """Chebyshev-Lobatto nodes: both ends of the step are among them. K = count + 1."""

    phases: Float[np.ndarray, " K"]
    """Phases of the nodes, from 0 to 1."""
    integrals: Float[np.ndarray, "K K"]
    """Row i times values at the nodes: the integral, from phase 0 to node i, of the polynomial
    through them."""

    @property
    def weights(self) -> Float[np.ndarray, " K"]:
        """Weights of the quadrature over the whole step (Clenshaw and Curtis)."""
        return self.integrals[-1]


def nodes(count: int) -> Nodes:
    """Return the nodes of polynomials of a degree `count`."""
    places = -np.cos(np.pi * np.arange(count + 1) / count)
    series = [chebyshev.chebint(one, scl=0.5, lbnd=-1.0) for one in np.eye(count + 1)]
    antiderivatives = np.stack([chebyshev.chebval(places, one) for one in series], axis=1)
    values = chebyshev.chebvander(places, count)
    return Nodes(0.5 * (1.0 + places), antiderivatives @ np.linalg.inv(values))
