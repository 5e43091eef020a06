"""What the operating system lends: memory, locks, shipped files, transport, threads, futures.

Knows no scene and no frame.
"""
