"""A robot with physics: two wheels, a laser, walls; on the names and types of a TurtleBot on ROS 2 Jazzy."""
