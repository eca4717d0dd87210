"""One file for each verb: it combines the rooms above into what a user requests."""
