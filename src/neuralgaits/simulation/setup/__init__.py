"""What an episode is given: plant, ground, disturbances, orders and where it starts."""
