"""`ros2 launch`; what a launch file is made of has a room of its own, launching."""
