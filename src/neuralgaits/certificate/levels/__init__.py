"""Theorems of the proof levels: what each one states, requires and concludes."""
