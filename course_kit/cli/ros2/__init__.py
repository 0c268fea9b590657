"""The `ros2` command, in a terminal and as `%ros2` in a notebook: one module a command, its verbs in it.

Written for the commands, options, outputs and exit statuses of ROS 2 Jazzy. Where a sourced ROS 2 brings its own
`ros2`, that one is used and this one is not installed.
"""
