"""NumPy and data types to ROS messages and back, as `sensor_msgs_py` is to `sensor_msgs`.

Pure conversions: no node, no topic, no file. A `Frame` becomes messages here, and
messages become arrays and data types.
"""
