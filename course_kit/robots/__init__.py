"""The robots of the course: the turtle simulator, the robot with physics, its navigation, and tf2.

It asks base and ros.
"""
