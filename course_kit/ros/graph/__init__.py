"""The ROS graph: as data, if all of it is known, and as a picture."""
