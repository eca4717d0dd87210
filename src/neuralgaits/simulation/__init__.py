"""Simulation of the robot at full order, in MuJoCo or Drake."""
