"""The socket protocol of the original SAILenv client, so that its scripts run on this simulator.

Bytes in, requests to `simulation/` and bytes out. Knows no ROS.
"""
