"""What the JSON files of a run look like, as far as reports show them. See `runs.shape`."""

from neuralgaits.runs.shape import (
    COUNT,
    FLAG,
    NUMBER,
    TEXT,
    Shape,
    list_of,
    may,
    one_of,
    same_length,
    table_of,
)

_VERDICT = one_of("proved", "refuted", "undecided", "rejected")
_TEXTS = list_of(TEXT)
_PAIR = list_of(NUMBER, 2)
_DISTURB = may(table_of(may(NUMBER)))

CERTIFIED: Shape = {
    "verdict": _VERDICT,
    "level": one_of(1, 2, 3, 4),
    "conditions": table_of(
        {
            "verdict": _VERDICT,
            "proved_fraction": NUMBER,
            "boxes": COUNT,
            "margin": may(NUMBER),
            "counterexample": may({"z": _PAIR, "margin": NUMBER}),
            "undecided_boxes": COUNT,
        }
    ),
    "levels": list_of(
        {
            "level": one_of(2, 3, 4),
            "verdict": _VERDICT,
            "reason": may(TEXT),
            "words?": _TEXTS,
            "figures?": table_of(may(NUMBER)),
            "constants?": may(
                list_of({"name": TEXT, "value": NUMBER, "unit": TEXT, "meaning": TEXT})
            ),
        }
    ),
    "boxes": COUNT,
    "wall_s": NUMBER,
    "proof?": may(TEXT),
    "sha256?": table_of(may(TEXT)),
}
"""`certificate/summary.json`."""

_SIMULATED: Shape = {
    "plant": TEXT,
    "controller": TEXT,
    "start": TEXT,
    "seed": COUNT,
    "episodes": COUNT,
    "steps?": COUNT,
    "push?": may(NUMBER),
    "disturb?": _DISTURB,
    "steps_walked": list_of(COUNT),
    "fell": list_of(FLAG),
    "fall_reasons": list_of(may(TEXT)),
    "logs?": may(_TEXTS),
    "plant_given?": may(TEXT),
    "link?": {
        "law": TEXT,
        "mode": TEXT,
        **{f"{name}?": may(NUMBER) for name in ("loss", "jitter_ms", "blend_s")},
    },
    "sha256?": table_of(TEXT),
    "poincare?": may({"multiplier": may(NUMBER), "step_length_m": may(NUMBER)}),
    **{
        f"{name}?": may(NUMBER)
        for name in (
            "speed_m_s",
            "step_time_s",
            "cost_of_transport",
            "peak_torque_nm",
            "steady_peak_torque_nm",
            "max_joint_rate_rad_s",
            "max_output_error_rad",
            "min_normal_force_n",
            "saturated_fraction",
        )
    },
}
SIMULATED: Shape = same_length(_SIMULATED, "steps_walked", "fell", "fall_reasons")
"""`simulation/summary.json`."""

ERRORS: Shape = {
    "heldout_error?": may(NUMBER),
    "nominal_heldout_error?": may(NUMBER),
    "binned_floor?": may(NUMBER),
    "wall_s?": may(NUMBER),
}
"""`residual/summary.json`, as far as a table of rounds tells of it."""

LEARNED: Shape = {
    "residual_sha256?": TEXT,
    "logs": _TEXTS,
    "walked_s": NUMBER,
    "strides": {"train": COUNT, "heldout": COUNT},
    "heldout_error": may(NUMBER),
    "nominal_heldout_error": may(NUMBER),
    "binned_floor": may(NUMBER),
    "error_bound": list_of(NUMBER, 2),
    "wall_s": NUMBER,
}
"""`residual/summary.json`."""

_WALKS = {
    "steps_walked": list_of(COUNT),
    "share_that_walks": may(NUMBER),
    # Of a robot's own logs nobody says why it fell.
    "fall_reasons?": list_of(may(TEXT)),
    "speed_range_m_s": may(_PAIR),
    "speed_m_s?": may(NUMBER),
    "barriers": {"tube": may(NUMBER), "all": may(NUMBER), "conditions": table_of(may(NUMBER))},
}
WALKED: Shape = {**_WALKS, "logs": _TEXTS, "wall_s": NUMBER}
"""`walks/summary.json` of a round of episodes."""

ROUNDS: Shape = {
    "robot": TEXT,
    "plant": may(TEXT),
    "disturb?": _DISTURB,
    "controller": TEXT,
    "logs": may(TEXT),
    "diverged?": may(TEXT),
    "rounds": list_of(
        {
            "round": COUNT,
            "loss": may(NUMBER),
            **_WALKS,
            "heldout_error": may(NUMBER),
            "nominal_heldout_error": may(NUMBER),
            "binned_floor": may(NUMBER),
        }
    ),
}
"""`summary.json` of episodes."""

RECORDED: Shape = {
    "key": TEXT,
    "robot": TEXT,
    "plant": TEXT,
    "controller": TEXT,
    "origin": TEXT,
    "push_n_s": may(NUMBER),
    "disturb": _DISTURB,
    "steps_walked": COUNT,
    "fell": FLAG,
    "fall_reason": may(TEXT),
    "frame_s": NUMBER,
    "force_n": may(list_of(_PAIR)),
}
"""`report/walk.json`."""
