"""A controller in a process of its own: the wire, what the network does to it, both ends."""
