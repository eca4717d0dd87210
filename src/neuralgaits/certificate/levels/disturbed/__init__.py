"""Level 5: the full order under a disturbance of what the outputs do."""
