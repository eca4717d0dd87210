"""Level 4: the robot walks on at full order."""
