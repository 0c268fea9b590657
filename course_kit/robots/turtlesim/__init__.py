"""A turtlesim without a window: the simulator and its keyboard, on the names and types of the original; a laser."""
