"""Forged proof files and run folders, and what each checker must answer."""
