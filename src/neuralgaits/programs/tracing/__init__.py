"""Tracing of a JAX function to a Program."""
