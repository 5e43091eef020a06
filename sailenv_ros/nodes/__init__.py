"""Thin ROS 2 nodes: they translate between topics or services and the simulation, no more."""
