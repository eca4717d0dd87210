"""Level 2: an invariant set of the hybrid zero dynamics."""
