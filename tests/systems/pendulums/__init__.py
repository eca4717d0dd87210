"""A family as small as one can be: a weight on a rod, which hangs."""

from neuralgaits.systems.system_family import SystemFamily

FAMILY = SystemFamily(
    name="pendulum",
    words="a pendulum",
    built_in={"pendulum": "a weight on a rod"},
    recognises=lambda robot: str(robot) == "pendulum",
    assumptions=("the rod is rigid",),
    with_levels=lambda report, claims: report,
)
