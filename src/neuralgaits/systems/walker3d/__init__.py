"""A biped in three dimensions on point feet, the yaw of its torso held."""
