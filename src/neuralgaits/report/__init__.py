"""Figures and the page of a run, drawn from saved data."""
