"""Families of systems: each folder has a model, its policies, conditions and verbs."""
