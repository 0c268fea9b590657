#!/usr/bin/env python3
"""simulator: the turtle, as `ros2 run turtlesim turtlesim_node` without a window."""

from course_kit.robots.turtlesim.__main__ import main

if __name__ == "__main__":
    main()
