"""A command line of each verb that works in the course, beside the turtle simulator: what its help ends with.

Those of one command build on each other: what is recorded is played, what is dumped is loaded.
"""

from __future__ import annotations

EXAMPLES = """
action info /turtle1/rotate_absolute
action list -t
action send_goal /turtle1/rotate_absolute turtlesim/action/RotateAbsolute "{theta: 1.57}" --feedback
action type /turtle1/rotate_absolute
bag record -o drive /turtle1/pose /turtle1/cmd_vel
bag info drive
bag play drive --rate 2
bag reindex drive
daemon start
daemon status
daemon stop
doctor --report
doctor hello --once
interface list --only-srvs
interface package turtlesim
interface packages
interface proto geometry_msgs/msg/Twist
interface show geometry_msgs/msg/Twist
launch turtlesim multisim.launch.py
lifecycle nodes
lifecycle list /lc_talker
lifecycle set /lc_talker configure
lifecycle get /lc_talker
node info /turtlesim
node list
param describe /turtlesim background_r
param dump /turtlesim > turtlesim.yaml
param get /turtlesim background_r
param list /turtlesim --param-type
param load /turtlesim turtlesim.yaml
param set /turtlesim background_r 150
param delete /my_node my_parameter
pkg create my_package --build-type ament_python --license Apache-2.0 --node-name my_node
pkg executables turtlesim
pkg list
pkg prefix turtlesim --share
pkg xml turtlesim --tag version
run turtlesim turtlesim_node --ros-args -r __node:=my_turtle
service call /turtle1/teleport_relative turtlesim/srv/TeleportRelative "{linear: 2.0, angular: 1.57}"
service echo /add_two_ints
service find std_srvs/srv/Empty
service info /spawn
service list -t
service type /spawn
topic bw /turtle1/pose
topic delay /scan
topic echo /turtle1/pose --once
topic find geometry_msgs/msg/Twist
topic hz /turtle1/pose
topic info /turtle1/cmd_vel --verbose
topic list -t
topic pub --rate 1 /turtle1/cmd_vel geometry_msgs/msg/Twist "{linear: {x: 2.0}, angular: {z: 1.8}}"
topic type /turtle1/cmd_vel
""".strip().splitlines()


def example(verb: str) -> str | None:
    """The line that ends the help of a verb such as 'topic hz'; None if there is none for it."""
    verb = verb.replace("wtf", "doctor")  # its other name
    return next((f"Example: ros2 {line}" for line in EXAMPLES if f"{line} ".startswith(f"{verb} ")), None)
