"""Gaits that are given, not trained: Bezier outputs of a published or an optimised orbit."""
