"""What each level of a proof states, asks and concludes."""
