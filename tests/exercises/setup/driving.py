"""Right answers to setup-3, the corners, driven in every way."""

from __future__ import annotations

from tests.exercises.chapter import changed, worked

TOUR = worked("setup-3")

# Each way has a direction and the place where it ends, so that a slow machine ends it no sooner.
WAYS = """
ways = [
    (6.0, -6.0, lambda pose: pose.x > 10.0 and pose.y < 1.0),
    (-12.0, 0.0, lambda pose: pose.x < 1.0),
    (0.0, 12.0, lambda pose: pose.y > 10.0),
    (12.0, 0.0, lambda pose: pose.x > 10.0),
]
"""

# With keys: turned by the rotate action, to which letters stand, and driven by arrows.
KEYS = (
    WAYS
    + """
from rclpy.parameter import Parameter
stop()
turtlesim = run(TurtleSim)
corners = record("/turtle1/pose")
panel = drive()
panel.teleop.set_parameters([Parameter("scale_linear", value=6.0)])
wait_for(lambda: corners.messages)
for key, (_, _, is_there) in zip("bdrg", ways):
    panel.press(key)
    wait_for(lambda: corners.messages[-1].angular_velocity, timeout=20)
    wait_for(lambda: corners.messages[-1].angular_velocity == 0.0, timeout=20)
    while not is_there(corners.messages[-1]):
        panel.press("up")
        wait_for(lambda: corners.messages[-1].linear_velocity, timeout=20)
        wait_for(lambda: corners.messages[-1].linear_velocity == 0.0, timeout=20)
panel.close()
"""
)

SIDEWAYS = (
    WAYS
    + """
import time
from geometry_msgs.msg import Twist, Vector3
from rclpy.parameter import Parameter
stop()
turtlesim = run(TurtleSim)
turtlesim.set_parameters([Parameter("holonomic", value=True)])
corners = record("/turtle1/pose")
wait_for(lambda: corners.messages)
for x, y, is_there in ways:
    while not is_there(corners.messages[-1]):
        go(x, y)
"""
)

# A publisher for each command, gone at once: the checker hears hardly one of them.
PUBLISHERS = changed(
    SIDEWAYS,
    (
        "for x, y, is_there",
        """
def go(x, y):
    publisher = turtlesim.create_publisher(Twist, "turtle1/cmd_vel", 10)
    wait_for(publisher.get_subscription_count)
    publisher.publish(Twist(linear=Vector3(x=x, y=y)))
    time.sleep(1.15)
    turtlesim.destroy_publisher(publisher)

for x, y, is_there""",
    ),
)

# A new process and a new publisher for each command.
TERMINAL = changed(
    SIDEWAYS,
    (
        "for x, y, is_there",
        """
from course_kit import start

def go(x, y):
    values = f"{{linear: {{x: {x}, y: {y}}}}}"
    command = ["ros2", "topic", "pub", "--once", "/turtle1/cmd_vel", "geometry_msgs/msg/Twist", values]
    start(command, name="pub").wait(60)
    time.sleep(1.1)

for x, y, is_there""",
    ),
)

MAGIC = changed(
    SIDEWAYS,
    (
        "for x, y, is_there",
        """
def go(x, y):
    values = f"{{linear: {{x: {x}, y: {y}}}}}"
    get_ipython().run_line_magic("ros2", f'topic pub --once /turtle1/cmd_vel geometry_msgs/msg/Twist "{values}"')
    time.sleep(1.1)

for x, y, is_there""",
    ),
)

# Sideways and backwards, many commands a second, first nonsense and a reset; and it never looks where it goes.
HOLONOMIC = (
    WAYS
    + """
import threading, time
from geometry_msgs.msg import Twist
from rclpy.parameter import Parameter
from std_srvs.srv import Empty
stop()
turtlesim = run(TurtleSim)
turtlesim.set_parameters([Parameter("holonomic", value=True)])
corners = record("/turtle1/pose")
wait_for(lambda: corners.messages)
pilot = run(Node, "pilot")
publisher = pilot.create_publisher(Twist, "/turtle1/cmd_vel", 1)
reset = pilot.create_client(Empty, "/reset")

def go(x, y, is_there):
    twist = Twist()
    twist.linear.x, twist.linear.y = x, y
    while not is_there(corners.messages[-1]):
        publisher.publish(twist)
        time.sleep(0.005)

go(-20.0, 3.0, lambda pose: pose.x < 1.0)
go(0.0, 0.0, lambda pose: pose.linear_velocity == 0.0)
wait_for(reset.call_async(Empty.Request()))
wait_for(lambda: abs(corners.messages[-1].x - 5.5) < 0.1)
work = threading.Thread(target=lambda: [go(*way) for way in ways])
work.start()
work.join()
"""
)

# In a process, whose turtle was killed and came again; the tour goes on for ever.
PROCESS = changed(
    TOUR,
    ("        self.left = list(self.goals)\n", "        self.left = list(self.goals)\n        self.rounds = 0\n"),
    (
        "        self.publisher.publish(twist)\n",
        """        else:
            self.left = list(self.goals)
            self.rounds += 1
        self.publisher.publish(twist)
""",
    ),
    (
        "turtlesim = run(TurtleSim)\n",
        """from course_kit import start
from turtlesim.srv import Kill, Spawn
turtlesim = start("ros2 run turtlesim turtlesim_node")
asker = run(Node, "asker")
kill, spawn = asker.create_client(Kill, "kill"), asker.create_client(Spawn, "spawn")
assert kill.wait_for_service(timeout_sec=20) and spawn.wait_for_service(timeout_sec=20)
wait_for(kill.call_async(Kill.Request(name="turtle1")))
wait_for(spawn.call_async(Spawn.Request(name="turtle1", x=5.0, y=4.0, theta=1.0)))
""",
    ),
    ("wait_for(lambda: not tour.left, timeout=60)\n", "wait_for(lambda: tour.rounds, timeout=60)\n"),
    ("wait_for(lambda: corners.messages[-1].linear_velocity == 0.0)\n", ""),
)

# Fast, on a path of its own.
FAST = changed(TOUR, ("8.0 * max(", "60.0 * max("), ("8.0 * turn", "30.0 * turn"), ("< 0.4", "< 1.5"))

STYLES = {
    "keys": KEYS,
    "publishers": PUBLISHERS,
    "terminal": TERMINAL,
    "magic": MAGIC,
    "holonomic": HOLONOMIC,
    "process": PROCESS,
    "fast": FAST,
}
