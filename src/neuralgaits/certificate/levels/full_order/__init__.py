"""Level 4: walking of the robot at full order."""
