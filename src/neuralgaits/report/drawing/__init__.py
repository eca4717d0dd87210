"""What all figures share: their look, the robot in lines, files, and who writes them."""
