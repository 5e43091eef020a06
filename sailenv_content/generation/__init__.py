"""Rooms from a seed: rules in data in, scene files out that have passed all checks."""
