"""What `fit` learned: `residual/summary.json` of a run."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from neuralgaits.records.record import Count, Pair, Record, Texts


@dataclass(frozen=True)
class ResetErrors:
    """Root mean square errors of the reset map. Units are in the names."""

    z1_m: float
    z2_kg_m2_s: float
    output_rad: float
    rate_rad_s: float


@dataclass(frozen=True)
class TouchdownErrors:
    """Errors at held-out touchdowns. Attributes: before, after: the model's, and what is left."""

    count: int
    before: ResetErrors | None
    after: ResetErrors | None


@dataclass(frozen=True, kw_only=True)
class StrideCounts:
    """Numbers of strides of each kind."""

    train: Count
    validation: Count = 0
    heldout: Count


@dataclass(frozen=True, eq=False)
class Logs(Record):
    """The logs that a summary names, whatever else it holds."""

    logs: Texts


@dataclass(frozen=True, eq=False, kw_only=True)
class Fitted(Record):
    """What was learned from logs.

    Attributes:
        run: whose policy walked.
        residual, residual_sha256: the file of it.
        logs: files it was learned from.
        columns: file that says what their columns are.
        computed: what the logs do not hold but follows from what they do.
        optimizer, seed, steps: of the fit.
        windows: that were learned from.
        strides: of each kind.
        walked_s: time of walking in the logs.
        left_out: rows by reason.
        bound: largest residual (m/s, N m).
        error_bound: what dz may still be off by (m/s, N m).
        train_error, nominal_train_error: over 0.1 s of strides that were learned from, in scaled
            z, with what was learned and without.
        heldout_error, nominal_heldout_error: the same of strides that were not.
        binned_floor: error of the best table over z.
        touchdowns: errors of the reset map.
        wall_s: time.
    """

    run: str = ""
    residual: str = ""
    residual_sha256: str | None = None
    logs: Texts
    columns: str | None = None
    computed: Texts = ()
    optimizer: str = ""
    seed: int = 0
    steps: int = 0
    windows: int = 0
    strides: StrideCounts
    walked_s: float
    left_out: Mapping[str, int] = field(default_factory=dict)
    bound: Pair = (0.0, 0.0)
    error_bound: Pair
    train_error: float | None = None
    nominal_train_error: float | None = None
    heldout_error: float | None
    nominal_heldout_error: float | None
    binned_floor: float | None
    touchdowns: TouchdownErrors | None = None
    wall_s: float

    @property
    def better(self) -> bool:
        """Whether it predicts held-out strides better than the model alone."""
        learned, nominal = self.heldout_error, self.nominal_heldout_error
        return learned is not None and nominal is not None and learned < nominal
