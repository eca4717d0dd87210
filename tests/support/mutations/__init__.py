"""Altered proof files, and what is known of each."""
