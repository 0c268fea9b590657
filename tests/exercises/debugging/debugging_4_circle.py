"""Answers to debugging-4: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

import math

from tests.exercises.chapter import Answers, Wrong, changed, worked

# A level that an answer before it has set stays in the kernel.

CIRCLE = worked("debugging-4")
DRIVE = """
stop()

class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.forward, self.turning = 0.0, 0.0
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_timer(0.1, self.tick)

    def tick(self):
        twist = Twist()
        twist.linear.x, twist.angular.z = self.forward, self.turning
        self.publisher.publish(twist)

def drive(forward, turning, seconds):
    driver.forward, driver.turning = forward, turning
    time.sleep(seconds)

turtlesim, driver = run(TurtleSim), run(Driver)
"""
# Through the field, a rest, two rounds to the right, the turtle's own bag format; its path as an object.
ROUNDS = f"""{DRIVE}
with bags.record("rounds", "turtle1/pose", "turtle1/cmd_vel", storage="sqlite3", overwrite=True) as bag:
    drive(1.5, 0.0, 1.0)
    drive(0.0, 0.0, 0.5)
    drive(-3.0, -3.0, 4.5)
stop()
circle = bag.path
"""
# One command a second holds just so long.
SELDOM = """
stop()
import pathlib

run(TurtleSim)
driver = run(Node, "driver")
publisher = driver.create_publisher(Twist, "turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x, twist.angular.z = 1.0, 1.0
with bags.record("circle", "/turtle1/pose", "/turtle1/cmd_vel", overwrite=True) as bag:
    wait_for(lambda: publisher.get_subscription_count() == 2)
    for _ in range(9):  # a whole circle takes more than six on a busy machine, too
        publisher.publish(twist)
        time.sleep(1.0)
stop()
circle = pathlib.Path("circle").resolve()
"""


def drives(*parts: tuple[float, float, float]) -> str:
    """A bag of a drive in parts: m/s, rad/s, seconds."""
    lines = "".join(f"    drive({forward}, {turning}, {seconds})\n" for forward, turning, seconds in parts)
    record = 'with bags.record("circle", "/turtle1/pose", "/turtle1/cmd_vel", overwrite=True):'
    return f'{DRIVE}\n{record}\n{lines}stop()\ncircle = "circle"\n'


ANSWERS = Answers(
    "debugging-4",
    2,
    CIRCLE,
    [
        Wrong("topics", changed(CIRCLE, (', "/turtle1/cmd_vel", over', ", over")), 1, "name the topics"),
        Wrong("slow", changed(CIRCLE, ("2.0, 1.2", "0.5, 0.4")), 1, "A circle takes"),
        Wrong("no_bag", changed(CIRCLE, ('circle = "circle"', 'circle = "square"')), 0, "in which the notebook"),
        Wrong(
            "all_topics",
            changed(CIRCLE, ('"/turtle1/pose", "/turtle1/cmd_vel", ', ""), ("440", "1000")),
            1,
            "name the topics",
        ),
        Wrong("short", changed(CIRCLE, ("2.0, 1.2", "2.0, 3.0"), ("440", "200")), 1, "drive while it records"),
        Wrong("spins", drives((2.0, 0.0, 2.0), (0.0, 3.0, 4.0)), 1, "drive and turn at the same time"),
        Wrong("too_slow", drives((2.0, 0.0, 1.0), (0.8, 1.5, 7.0)), 1, "0.8 m/s where it is slowest"),
        Wrong("square", drives(*[(2.0, 0.0, 1.0), (0.0, math.pi / 2, 1.0)] * 4), 1, "never round on one circle"),
        Wrong("spiral", drives(*[(1.0 + 0.5 * n, 1.5, 0.7) for n in range(8)]), 1, "never round on one circle"),
    ],
    {"path": changed(CIRCLE, ('circle = "circle"', "circle = bag.path")), "rounds": ROUNDS, "seldom": SELDOM},
)
