"""What figures, report and viewer show of a gait, computed without compiling anything."""
