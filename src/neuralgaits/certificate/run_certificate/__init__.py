"""The certificate of a run: what it is about, its files, and what may be said after reading it."""
