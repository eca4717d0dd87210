"""Trace a run of a walker in three dimensions again, in a process of its own."""

from neuralgaits.systems.family_retrace import answer_for
from neuralgaits.systems.walker3d.spatial_system import SYSTEM

if __name__ == "__main__":
    answer_for(SYSTEM)
