"""What runs Python launch files where the real `launch` and `launch_ros` are not installed.

The modules of this package do the work; `stand_ins/` holds the packages `launch` and `launch_ros` that a launch file
imports, put on sys.path only for a launch. The order of events and the output are those of the real ones.
"""
