"""Level 5: walking at full order under a disturbance of the outputs' acceleration."""
