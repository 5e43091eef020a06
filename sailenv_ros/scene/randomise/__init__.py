"""Randomisation of a scene: distributions, things to draw, and drawing, without physics."""
