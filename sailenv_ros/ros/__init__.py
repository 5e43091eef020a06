"""ROS 2: the nodes of the simulator, and the client that reaches them."""
