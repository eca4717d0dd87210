"""Write the log of a simulated walk: readings of the robot itself, and z2 of the plant."""

import numpy as np

from neuralgaits.gait.zero_coordinates import momenta_of
from neuralgaits.logs import Log
from neuralgaits.simulation.ticks.tick import TickRecord


def log_of(joint_names: tuple[str, ...], record: TickRecord, source: str) -> Log:
    """Return the log of a recorded episode.

    Args:
        joint_names: names of the joints of the controller's model, one a coordinate.
        record: record of the episode; every leaf has a leading axis of ticks.
        source: name of the episode in messages.
    """
    result = record.result
    return Log(
        t=np.asarray(record.time),
        stance=np.asarray(result.leg, dtype=int),
        q=np.asarray(result.q),
        dq=np.asarray(result.dq),
        qd=np.asarray(result.y_d),
        dqd=np.asarray(result.dy_d),
        tau=np.asarray(result.actuated),
        pitch=np.asarray(record.pitch),
        dpitch=np.asarray(record.dpitch),
        z=np.asarray(result.z),
        z2_plant=np.asarray(momenta_of(record.z_plant)),
        rows=np.arange(1, 1 + len(record.time)),
        joint_names=joint_names,
        source=source,
    )
