"""Runs of the biped in three dimensions that tests share."""

SPEEDS = 0.62, 0.68
"""Range of the speeds that the shared gait is told [m/s]."""
