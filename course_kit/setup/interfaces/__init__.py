"""ROS packages that no wheel brings: their definitions of interfaces are compiled at install."""
