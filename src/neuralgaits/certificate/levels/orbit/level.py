"""Level 3: one periodic orbit attracts the walking set, or walks under the same commands meet."""

from neuralgaits.certificate.level import Level, lists_of
from neuralgaits.certificate.levels.orbit.conclude import attraction
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants, labelled_premises

LEVEL = Level(
    3,
    "orbit",
    OrbitConstants,
    lists_of,
    lambda known, boxes: labelled_premises(known[2], known[3]),
    lambda known, boxes, bounds: attraction(known[2], known[3], bounds),
    rests_on=(2,),
)
