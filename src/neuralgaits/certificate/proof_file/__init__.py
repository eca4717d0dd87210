"""Proof files: written from searches; read and checked by code that shares nothing with them."""
