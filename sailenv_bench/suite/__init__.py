"""The speed benchmarks as one run: measurements of every part in, one table out.

`sailenv bench all` runs them. A part is a function that returns `Measurement`s; see `parts`.
"""
