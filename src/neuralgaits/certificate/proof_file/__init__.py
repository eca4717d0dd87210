"""Proof files: written, read, and checked by code that shares nothing with the search."""
