"""Rounds of walking, learning and refining: their folder, and the walks of one round."""
