"""`ros2 doctor`."""
