"""Level 3: one periodic orbit attracts all of that set."""
