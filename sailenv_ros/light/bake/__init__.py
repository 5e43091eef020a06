"""Computes beforehand how light falls on what stands still: lamps, sun, sky, and what bounces."""
