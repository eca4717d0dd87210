"""Results of learning from logs as tables for a person, on stdout."""

from rich.text import Text

from neuralgaits.cli.screen_tables import short, show_facts, show_sentence, show_table
from neuralgaits.records.fitted import FitSummary, TouchdownErrors


def show_fit(result: FitSummary) -> None:
    """Show errors with and without the residual, at touchdowns, too, and the data that was used."""
    learned = result.heldout_error
    nominal = result.nominal_heldout_error
    better = result.better
    share = f"{100.0 * learned / nominal:.3g} %" if nominal and learned is not None else "all"
    verdict = Text("learned" if better else "not learned", "green" if better else "red")
    show_sentence(verdict, f": {share} of the model's error is left on held-out strides")
    floor = short(result.binned_floor)
    trained = short(result.nominal_train_error), short(result.train_error)
    show_table(
        ("error over 0.1 s, in steps and momenta", "model", "learned", "best table"),
        [
            ("learned from", *trained, ""),
            ("held out", short(nominal), short(learned), floor),
        ],
    )
    _landings(result.touchdowns)
    bounds = ("what dz may still be off by", result.error_bound), ("largest residual", result.bound)
    show_table(
        ("", "m/s", "N m"),
        [(label, *(short(value) for value in pair)) for label, pair in bounds],
    )
    strides = ", ".join(f"{count} {name}" for name, count in vars(result.strides).items())
    out = ", ".join(f"{count} {reason}" for reason, count in result.left_out.items() if count)
    show_facts(
        [
            ("used", f"{result.walked_s:.1f} s of walking, strides: {strides}"),
            ("rows left out", out or "none"),
            *(("computed", what) for what in result.computed),
            ("time", f"{result.wall_s:.0f} s"),
        ]
    )


def _landings(touchdowns: TouchdownErrors | None) -> None:
    """Show the errors at touchdowns, which the residual of the flow does not cover."""
    if touchdowns is None or touchdowns.before is None:
        return
    head = f"error at {touchdowns.count} held-out touchdowns"
    rows = []
    landings = (
        ("z1_m", "hip position z1", "m"),
        ("z2_kg_m2_s", "momentum z2", "kg m²/s"),
        ("output_rad", "outputs", "rad"),
        ("rate_rad_s", "output rates", "rad/s"),
    )
    for name, label, unit in landings:
        before, after = (getattr(one, name, None) for one in (touchdowns.before, touchdowns.after))
        corrected = "-" if after is None else f"{short(after)} {unit}"
        rows.append((label, f"{short(before)} {unit}", corrected))
    show_table((head, "model", "learned"), rows)
