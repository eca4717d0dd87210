"""Folder of the rounds of walking, learning and refining, and the walks of one round."""
