"""Programs bounded by compiled code, where there is a compiler."""
