"""Shared parts of all figures: their style, the robot as a line drawing, and their files."""
