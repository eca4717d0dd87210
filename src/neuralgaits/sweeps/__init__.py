"""Sweeps: their folder, their combinations, and their table."""
