"""Proofs that conditions hold for every state of their regions, and the check of such proofs.

`search/` is the finder, not the judge: what it finds is written to a proof file that is read and
checked without it. So this room imports nothing by itself.
"""
