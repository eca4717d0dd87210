"""Figures from saved data; nothing is computed again here."""
