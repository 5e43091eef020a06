"""Recordings in MCAP: written with or without DDS, read at random, repaired, played, exported.

`Frame`s or serialized messages → `RecordingWriter` → a bag folder → `RecordingReader` → messages,
frames, data sets. Only `channels` and `schemas` know ROS messages; nothing here knows a node.
"""
