"""The command line: `ros2` with its verbs, and launch files.

It asks base, ros and lab.
"""
