"""Walks in compiled code: `c/walk.c`, its structures in Python, and the loop around it."""
