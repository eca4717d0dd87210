"""One control tick, and the loop that runs it for many episodes in lock-step."""
