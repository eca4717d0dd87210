"""Level 2: every trajectory that starts in the walking set walks for ever."""

from neuralgaits.certificate.level import Level, lists_of
from neuralgaits.certificate.levels.walking_set.conclude import walking
from neuralgaits.certificate.levels.walking_set.theorem import (
    WalkingSetConstants,
    labelled_premises,
)

LEVEL = Level(
    2,
    "walking",
    WalkingSetConstants,
    lists_of,
    lambda known, boxes: labelled_premises(known[2], boxes),
    lambda known, boxes, bounds: walking(known[2], boxes, bounds),
)
