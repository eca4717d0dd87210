"""Gaits from files or optimisation, without training: Bezier outputs of a given orbit."""
