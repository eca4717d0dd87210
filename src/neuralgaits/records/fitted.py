"""Result of `fit`: `residual/summary.json` of a run."""

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
    """Errors at held-out touchdowns. Attributes: before, after: without and with the residual."""

    count: int
    before: ResetErrors | None
    after: ResetErrors | None


@dataclass(frozen=True, kw_only=True)
class StrideCounts:
    """Numbers of strides in the training, validation and test sets."""

    train: Count
    validation: Count = 0
    heldout: Count


@dataclass(frozen=True, eq=False)
class Logs(Record):
    """Log files of a summary, whatever else it holds.

    Attributes:
        logs: files of the walks.
        sha256: hashes of the files of the gait that walked, by file; empty if not recorded.
    """

    logs: Texts
    sha256: Mapping[str, str | None] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class FittedGait(Record):
    """Gait that a residual is of, in the summary of `fit`. Attributes: as of `FitSummary`."""

    residual_sha256: str | None = None
    sha256: Mapping[str, str | None] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class FitSummary(Record):
    """Result of learning from logs.

    Attributes:
        run: run whose policy walked.
        residual, residual_sha256: file of the residual, and its hash.
        sha256: hashes of the files of the gait that walked, by file; empty in summaries of
            earlier versions.
        logs: files it was learned from.
        columns: file that describes their columns.
        computed: quantities that were computed because the logs do not hold them.
        optimizer, seed, steps: settings of the fit.
        windows: number of windows that were learned from.
        strides: number of strides of each kind.
        walked_s: time of walking in the logs.
        left_out: number of rows left out, by reason.
        bound: largest residual (m/s, N m).
        error_bound: bound on the remaining error of dz (m/s, N m).
        train_error, nominal_train_error: error over 0.1 s of the training strides, in scaled
            z, with the residual and without.
        heldout_error, nominal_heldout_error: likewise for held-out strides.
        binned_floor: error of the best table over z.
        touchdowns: errors of the reset map.
        wall_s: elapsed time.
    """

    run: str = ""
    residual: str = ""
    residual_sha256: str | None = None
    sha256: Mapping[str, str | None] = field(default_factory=dict)
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
        """Whether the residual predicts held-out strides better than the model alone."""
        learned, nominal = self.heldout_error, self.nominal_heldout_error
        return learned is not None and nominal is not None and learned < nominal
