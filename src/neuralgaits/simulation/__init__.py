"""Full-order simulation in MuJoCo."""
