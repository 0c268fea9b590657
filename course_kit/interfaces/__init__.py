"""Definitions of messages, services and actions that ROS 2's wheels do not bring, compiled at install."""
