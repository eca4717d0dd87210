"""Log files of every format: what their columns are, read and written."""
