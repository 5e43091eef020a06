"""Keeps baked light right while what was baked moves."""
