"""Furniture from seeds: families of pieces that code makes, each by its style and its seed.

``chair~dining:17`` in, an `Asset` out, the same to the byte each time. A family is one module in
`kinds`; what opens of a piece has a joint of its own.
"""
