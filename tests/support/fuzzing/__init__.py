"""Inputs altered at random, and the doors of the program that they are carried through."""
