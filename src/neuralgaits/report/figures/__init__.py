"""One file for each figure: how it is drawn, and its caption where that depends on the data."""
