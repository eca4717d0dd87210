"""Inputs of an episode: plant, ground, disturbances, commands and start."""
