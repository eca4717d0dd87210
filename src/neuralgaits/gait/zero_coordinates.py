"""Zero dynamics coordinates z = (p, s) of a mechanism with k joints that no motor drives.

The positions p = C q are k linear functions of the coordinates, the momenta s = -R(q) dq linear in
the rates. With outputs q_a = y, both lines are solved for the joints without motors, one k x k
solve each; at k = 1 that is a division. Source: docs/notation.md; Westervelt et al. (2007),
section 5.
"""

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import jax.numpy as jnp

from neuralgaits._types import Array, Coordinates, Float, Positions, ZeroState
from neuralgaits.robots.linear import solve


@runtime_checkable
class Mechanism(Protocol):
    """A mechanism that has zero dynamics: the first k of its n coordinates have no motor."""

    @property
    def n(self) -> int:
        """Number n of the mechanism's coordinates."""
        ...

    @property
    def position_rows(self) -> Float[Array, "k n"]:
        """Rows C of the positions, p = C q; the first k columns are invertible."""
        ...

    def momentum(self, q: Coordinates, dq: Coordinates) -> Positions:
        """Momenta s of the coordinates without motors, forward positive. [k]."""
        ...

    def momentum_rows(self, q: Coordinates) -> Float[Array, "k n"]:
        """Rows R of the momenta, s = -R dq."""
        ...

    def momentum_rate(self, q: Coordinates, dq: Coordinates | None = None) -> Positions:
        """Rates of the momenta, which no motor changes. [k].

        About a point contact only the weight has a moment, so that q is enough. Outputs may depend
        on such momenta only: on others, dq would follow from rates that follow from dq.
        """
        ...


def position_of(z: ZeroState) -> Any:
    """Return the position of a state with one, or its rate: a scalar of the state's own kind."""
    return z[0]


def momentum_of(z: ZeroState) -> Any:
    """Return the momentum of a state with one, or its rate: a scalar of the state's own kind."""
    return z[1]


def positions_of(states: Any) -> Any:
    """Return the position of each of many states with one, or its rate. [..., 2] to [...]."""
    return states[..., 0]


def momenta_of(states: Any) -> Any:
    """Return the momentum of each of many states with one, or its rate. [..., 2] to [...]."""
    return states[..., 1]


@dataclass(frozen=True)
class ZeroCoordinates:
    """Map between full states and zero dynamics states of a mechanism. Single states."""

    mechanism: Mechanism

    @property
    def k(self) -> int:
        """Number of positions, and of momenta."""
        return len(self.mechanism.position_rows)

    def split(self, z: ZeroState) -> tuple[Positions, Positions]:
        """Return positions and momenta of a state, or of its rate. [k], [k]."""
        return z[: self.k], z[self.k :]

    def of(self, q: Coordinates, dq: Coordinates) -> ZeroState:
        """Return the zero dynamics state z = (C q, s) of a full state (m, kg m^2/s). [2k].

        The units are those of a walker, whose row C is the gradient of its linearised hip position
        (m/rad) and whose s is the angular momentum about the stance foot, forward positive.

        Args:
            q: coordinates (rad). [n]
            dq: their rates (rad/s). [n]
        """
        momentum = self.mechanism.momentum(q, dq)
        return jnp.concatenate([product(self.mechanism.position_rows, q), momentum])

    def rate(self, q: Coordinates, dq: Coordinates) -> ZeroState:
        """Return the rate of the zero dynamics state in any full state of the model. [2k]."""
        momentum_rate = self.mechanism.momentum_rate(q, dq)
        return jnp.concatenate([product(self.mechanism.position_rows, dq), momentum_rate])

    def lift(
        self, positions: Float[Array, "k *columns"], actuated: Float[Array, "m *columns"]
    ) -> Float[Array, "n *columns"]:
        """Return coordinates with these positions and actuated joints.

        The map is linear, so it lifts rates and accelerations as well, and columns of them.

        Args:
            positions: [k], or [k, columns].
            actuated: [m], or [m, columns].

        Returns: [n], or [n, columns] (rad).
        """
        rows, k = self.mechanism.position_rows, self.k
        first = solved(rows[:, :k], positions - product(rows[:, k:], actuated))
        return jnp.concatenate([first, actuated])

    def along(self, slopes: Float[Array, "m k"]) -> Float[Array, "n k"]:
        """Return coordinate rates per unit rate of each position, of outputs with these slopes.

        Args:
            slopes: derivatives of the outputs in the positions. [m, k]

        Returns: [n, k].
        """
        return self.lift(jnp.eye(self.k, dtype=slopes.dtype), slopes)

    def rates(
        self, q: Coordinates, momenta: Positions, slopes: Float[Array, "m k"], fixed: Coordinates
    ) -> Coordinates:
        """Return the coordinate rates that have these momenta, of outputs with these slopes.

        Args:
            q: coordinates (rad). [n]
            momenta: s. [k]
            slopes: derivatives of the outputs in the positions. [m, k]
            fixed: part of the rates that the positions' rates do not change; see `still`. [n]

        Returns: [n] (rad/s).
        """
        rows, along = self.mechanism.momentum_rows(q), self.along(slopes)
        rate = solved(product(rows, along), -(momenta + product(rows, fixed)))
        return combined(along, rate) + fixed

    def still(self, actuated: Float[Array, "m *columns"]) -> Float[Array, "n *columns"]:
        """Return coordinate rates that leave the positions as they are; [m] or [m, columns]."""
        return self.lift(jnp.zeros((self.k, *actuated.shape[1:]), actuated.dtype), actuated)


def solved(matrix: Float[Array, "k k"], right: Array) -> Array:
    """Solve `matrix @ x = right` for [k] or [k, columns]: at k = 1, one division.

    The matrix need not be symmetric, but elimination without pivoting has to find its pivots.
    """
    if len(matrix) == 1:
        return right / matrix[0, 0]
    if right.ndim == 1:
        return solve(matrix, right)
    return jnp.stack([solve(matrix, column) for column in right.T], axis=1)


def product(rows: Float[Array, "k n"], right: Float[Array, "n *columns"]) -> Array:
    """Return `rows @ right` as inner products, which compile to the same code however few. [k]."""
    if right.ndim == 1:
        return jnp.stack([row @ right for row in rows])
    return jnp.stack([product(rows, column) for column in right.T], axis=1)


def combined(
    columns: Float[Array, "rows columns"], weights: Float[Array, " columns"]
) -> Float[Array, " rows"]:
    """Return the sum of columns times their weights; of one column, its product. [rows]."""
    total = columns[:, 0] * weights[0]
    for j in range(1, columns.shape[1]):
        total = total + columns[:, j] * weights[j]
    return total
