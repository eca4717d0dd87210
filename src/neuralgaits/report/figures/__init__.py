"""One file for each figure: its caption, and how it is drawn from saved data."""
