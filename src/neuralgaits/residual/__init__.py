"""Residual zero dynamics learned from measured windows."""
