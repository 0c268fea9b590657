"""`ros2 bag`."""
