"""Level 2: a set of the hybrid zero dynamics is invariant."""
