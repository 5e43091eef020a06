"""Views of a frame as pictures for people; arrays in, arrays and PNG files out. Knows no ROS."""
