"""What the process loads that `ros2` commands are forked from: see ros2_fork.py."""

from tests import ros2_fork

ros2_fork.load()
