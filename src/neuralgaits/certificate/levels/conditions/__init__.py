"""Level 1: every condition holds on its region."""
