"""Scheduled changes of the running scene: lessons, randomisation, scenarios."""
