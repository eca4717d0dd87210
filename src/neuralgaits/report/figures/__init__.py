"""A file for each figure: what it shows, and how it is drawn from saved data."""
