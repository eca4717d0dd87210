"""Trace a cart-pole's run again, in a process of its own."""

from neuralgaits.systems.cartpole.cartpole_verbs import SYSTEM
from neuralgaits.systems.family_retrace import answer_for

if __name__ == "__main__":
    answer_for(SYSTEM)
