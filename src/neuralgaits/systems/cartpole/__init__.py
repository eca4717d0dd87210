"""The cart-pole: a pole on a cart that one motor drives along a rail.

The second family beside walkers. It has no impacts, so a proof is about one flow and one set.
"""
