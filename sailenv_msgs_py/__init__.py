"""NumPy and data types to ROS messages and back, as `sensor_msgs_py` is to `sensor_msgs`.

Pure conversions: no node, no topic, no file. Whoever has a `Frame` gets messages here, and
whoever has messages gets arrays and data types.
"""
