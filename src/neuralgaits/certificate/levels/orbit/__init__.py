"""Level 3: one periodic orbit that attracts all of the walking set."""
