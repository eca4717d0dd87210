"""A row of a sweep without training: numbers that follow from its seed, to test all the rest."""

import json
import time
from pathlib import Path

from neuralgaits.engine import Files, Settings
from neuralgaits.records.swept import ROW, RowTimes, RowWalks, SweepRow
from neuralgaits.runs import to_json

HOLD, BROKEN = "hold", "broken"
"""Files in the folder of a sweep: rows with an odd seed wait for ever, or meet a defect."""
REFUSED_SEED = 2


def made_up(settings: Settings, files: Files) -> Files:
    """A row whose numbers follow from its settings. Only these tests let a task see a folder."""
    seed, sweep = settings["seed"], Path(settings["place"]).parents[1]
    while seed % 2 and (sweep / HOLD).exists():
        time.sleep(0.05)
    if seed % 2 and (sweep / BROKEN).exists():
        raise ZeroDivisionError("a defect")
    known = {name: settings[name] for name in ("name", "robot", "spec", "seed")}
    if seed == REFUSED_SEED:
        row = SweepRow(**known, failure="refused", reason="train: expected a <gait>, found none")
        return {ROW: to_json(row).encode()}
    walks = tuple(
        RowWalks(law, name, 4, 4 - (seed + place) % 2, 25, 0.7 + seed / 7, 0.1, 40.0, 90.0)
        for law in settings["controllers"]
        for place, name in enumerate(("none", *settings["disturbances"]))
    )
    row = SweepRow(
        **known,
        steps=2,
        loss=1.0 / (seed + 3),
        conditions=5,
        broken=seed % 2,
        verdict="proved",
        proved_level=2,
        margin=0.1 / (seed + 3),
        boxes=100 + seed,
        walks=walks,
        wall_s=RowTimes(time.perf_counter() % 7.0, 1.0, 2.0),
    )
    config = json.dumps({"robot": len(files["robot.xml"]), "seed": seed})
    return {"config.json": config.encode(), "certificate/proof.json": b"{}", ROW: _json(row)}


def unhurried(settings: Settings, files: Files) -> Files:
    """The same, after a tenth of a second: a kill can meet it."""
    time.sleep(0.1)
    return made_up(settings, files)


def _json(row: SweepRow) -> bytes:
    return to_json(row).encode()
