"""Shared parts of several verbs, and the parts of a sweep's rows."""
