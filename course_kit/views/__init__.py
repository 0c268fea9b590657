"""The views of a notebook that move: the turtle, the robot, the graph, logs, values, forms.

It asks base, ros, robots, lab and cli.
"""
