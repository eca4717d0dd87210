"""A controller in a process of its own: the wire, disturbances of the network, both ends."""
