"""Services of the operating system: memory, locks, shipped files, transport, threads, futures.

Knows no scene and no frame.
"""
