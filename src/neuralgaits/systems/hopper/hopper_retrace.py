"""Trace a hopper's run again, in a process of its own."""

from neuralgaits.systems.family_retrace import answer_for
from neuralgaits.systems.hopper.hopper_verbs import SYSTEM

if __name__ == "__main__":
    answer_for(SYSTEM)
