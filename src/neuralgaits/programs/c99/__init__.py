"""A Program as one C function."""
