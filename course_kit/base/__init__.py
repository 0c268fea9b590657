"""Text, figures, files, locks, processes and arguments: everything that knows nothing of ROS.

This is the lowest wing: it asks no other.
"""
