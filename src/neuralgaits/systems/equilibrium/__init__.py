"""Shared by families that are brought to rest: an ellipsoid of states around an equilibrium.

A family's model says how states move under a controller and which limits there are; from that
follow conditions, levels, training, episodes, exports and pictures here.
"""
