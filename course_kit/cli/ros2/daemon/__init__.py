"""`ros2 daemon`."""
