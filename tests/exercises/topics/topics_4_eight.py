"""Answers to topics-4: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

FIGURE_EIGHT = worked("topics-4")

KILLER = """
import threading
import time

from turtlesim.srv import Kill

class FigureEight(Node):
    def __init__(self):
        super().__init__("figure_eight")
        self.commands = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.poses = self.create_publisher(Pose, "turtle1/pose", 10)
        self.kill = self.create_client(Kill, "kill")
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        self.kill.wait_for_service(5.0)
        self.kill.call_async(Kill.Request(name="turtle1"))
        time.sleep(0.5)
        for sign in (1, -1):
            for step in range(201):
                angle = step / 200 * math.tau
                pose = Pose(x=5.5 + math.sin(angle), y=5.5 + sign * (1 - math.cos(angle)))
                pose.theta = math.remainder(sign * angle, math.tau)
                pose.linear_velocity, pose.angular_velocity = 2.0, sign * 2.0
                self.poses.publish(pose)
                time.sleep(0.016)
        while True:
            self.poses.publish(Pose(x=5.5, y=5.5))
            time.sleep(0.016)
"""

HOME_BY_TELEPORT = """
from turtlesim.srv import TeleportAbsolute

class FigureEight(Node):
    def __init__(self):
        super().__init__("figure_eight")
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.teleport = self.create_client(TeleportAbsolute, "turtle1/teleport_absolute")
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)
        self.home, self.count = None, 0

    def on_pose(self, pose):
        self.home = self.home or pose
        self.count += 1
        twist = Twist()
        if self.count <= 360:
            twist.linear.x, twist.angular.z = 2.0, (2.0 if self.count <= 180 else -2.0)
        if self.count <= 361:
            self.publisher.publish(twist)
        if self.count == 361:
            self.teleport.call_async(TeleportAbsolute.Request(x=self.home.x, y=self.home.y, theta=self.home.theta))
"""

DRIVER = """
class FigureEight(Node):
    def __init__(self):
        super().__init__("figure_eight")
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1000)
        self.ticks, self.has_ended = 0, False

    def on_pose(self, pose):
        if self.has_ended:
            return
        moves = pose.linear_velocity != 0 or pose.angular_velocity != 0
        self.ticks += self.ticks > 0 or moves
        step = int(self.ticks * 0.016 / 0.05)
        self.has_ended = step >= len(self.plan)
        twist = Twist()
        if not self.has_ended:
            twist.linear.x, twist.angular.z = self.plan[step]
        self.publisher.publish(twist)

    plan = """


def driving(*parts: str) -> str:
    """A class that drives what is listed: speeds ahead and around, each for 0.05 s of the simulator's.

    It counts the simulator's ticks, so the figure is the same if one of the two stands still for a moment. It counts
    from the tick that moves the turtle: the first commands may be lost, for the simulator finds the publisher later.
    """
    return f"{DRIVER}{' + '.join(parts)}\n"


# Slowly: the turtle goes on with the last command where the next one is late, and a figure is closed within 0.3 m.
LEFT, RIGHT = "[(1.25, math.tau / 6)] * 120", "[(1.25, -math.tau / 6)] * 120"
HALF_LEFT = "[(1.25, math.tau / 6)] * 60"
HALF_A_TURN = "[(0.0, math.pi)] * 20"
TO_THE_LEFT = "([(1.0, 0.0)] * 20 + [(0.0, math.pi / 4)] * 40) * 4"  # squares
TO_THE_RIGHT = "([(1.0, 0.0)] * 20 + [(0.0, -math.pi / 4)] * 40) * 4"
ENDS_SO = "        self.publisher.publish", "        if not self.has_ended:\n            self.publisher.publish"

WRONG = [
    Wrong(
        "both_left",
        changed(
            FIGURE_EIGHT,
            ("self.sign * 2.0", "2.0"),
            ("self.turned <= 0.03", "self.turned >= 2 * math.tau - 0.03"),
        ),
        2,
        "the opposite sign of angular.z",
    ),
    Wrong("sizes", changed(FIGURE_EIGHT, ("= 3.0,", "= 3.0 if self.sign > 0 else 2.0,")), 4, "Their lengths are"),
    Wrong("for_ever", changed(FIGURE_EIGHT, ("self.sign = 0", "self.sign = 1")), 0, "It still moves after"),
    Wrong(
        "one_circle", changed(FIGURE_EIGHT, ("self.sign = -1", "self.sign = 0")), 3, "After the first it turned by 0°"
    ),
    Wrong(
        "not_closed", changed(FIGURE_EIGHT, ("self.turned <= 0.03", "self.turned <= 0.6")), 3, "m from where it began"
    ),
    Wrong("killed", KILLER, 0, "turtle1 was killed"),
    Wrong("teleported", HOME_BY_TELEPORT, 0, "drive it by `/turtle1/cmd_vel` alone"),
    Wrong("on_the_spot", driving("[(0.0, math.pi)] * 40", "[(0.0, -math.pi)] * 40"), 0, "It turned by 0°"),
    Wrong("squares", driving(TO_THE_LEFT, TO_THE_RIGHT), 2, "of the radius off a circle"),
    Wrong("one_over_the_other", driving(LEFT, HALF_A_TURN, RIGHT), 4, "It lies over the first"),
    Wrong("rests_too_long", driving(LEFT, "[(0.0, 0.0)] * 90", RIGHT), 3, "After the first it turned by 0°"),
    Wrong("halves", driving(HALF_LEFT, RIGHT, HALF_LEFT), 2, "off a circle"),
    Wrong("tiny", driving("[(0.2, math.tau / 3)] * 60", "[(0.2, -math.tau / 3)] * 60"), 4, "Their lengths are 0.6 m"),
    Wrong("overlap", driving(LEFT, "[(0.0, 1.2)] * 20", RIGHT), 4, "It lies over the first"),
    Wrong("three_circles", driving(LEFT, RIGHT, f"({LEFT})[16:]"), 1, "more than one circle"),
    # As slowly as the circles above: it turns further where the command that ends an arc is late.
    Wrong(
        "300_degrees",
        driving("[(1.25, math.tau / 6)] * 100", "[(1.25, -math.tau / 6)] * 100"),
        1,
        "before it turned the other way",
    ),
    # It does not stop the turtle, which a second without a command does: both at once would move it nowhere.
    Wrong("one_command", changed(driving("[(2.5, math.tau / 3)]"), ENDS_SO), 0, "a circle takes"),
]

STYLES = {
    "open_loop_right_first_with_a_rest": """
class FigureEight(Node):
    def __init__(self):
        super().__init__("figure_eight")
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.ticks = 0
        self.create_timer(0.05, self.tick)

    def tick(self):
        # 120 ticks a circle (6 s), 50 ticks' rest (2.5 s) between them
        if self.publisher.get_subscription_count() == 0 or self.ticks > 290:
            return
        twist = Twist()
        if self.ticks < 120 or 170 <= self.ticks < 290:
            twist.linear.x = 1.25
            twist.angular.z = (-1 if self.ticks < 120 else 1) * math.tau / 6
        self.publisher.publish(twist)
        self.ticks += 1
""",
    "slow_and_wide_for_88_s": """
class FigureEight(Node):
    def __init__(self):
        super().__init__("figure_eight")
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_timer(0.1, self.tick)
        self.began = None

    def tick(self):
        if not self.publisher.get_subscription_count():
            return
        now = self.get_clock().now().nanoseconds * 1e-9
        self.began = self.began or now
        circle = 44.0
        twist = Twist()
        if now - self.began < 2 * circle:
            twist.angular.z = math.tau / circle if now - self.began < circle else -math.tau / circle
            twist.linear.x = 2.5 * math.tau / circle
            self.publisher.publish(twist)
        else:
            self.publisher.publish(Twist())
            self.destroy_timer(next(iter(self.timers)))
""",
    "turns_first_and_comes_back_at_the_end": """
class FigureEight(Node):
    def __init__(self):
        super().__init__("figure_eight")
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1)
        self.step, self.turned, self.last, self.home = "face", 0.0, None, None

    def on_pose(self, pose):
        twist = Twist()
        turned = 0.0 if self.last is None else math.remainder(pose.theta - self.last, math.tau)
        self.last = pose.theta
        if self.step == "face":  # to the east, whatever it faced
            error = math.remainder(0.0 - pose.theta, math.tau)
            twist.angular.z = 3.0 * error
            if abs(error) < 0.01:
                self.step, self.home = "left", (pose.x, pose.y)
        elif self.step in ("left", "right"):
            self.turned += abs(turned)
            if self.turned > 6.1:
                self.step, self.turned = ("right" if self.step == "left" else "home"), 0.0
            sign = 1 if self.step == "left" else -1
            twist.linear.x, twist.angular.z = 1.8, sign * 1.5
        if self.step == "home":
            dx, dy = self.home[0] - pose.x, self.home[1] - pose.y
            error = math.remainder(math.atan2(dy, dx) - pose.theta, math.tau)
            twist = Twist()
            if math.hypot(dx, dy) > 0.1:
                twist.linear.x, twist.angular.z = (0.3 if abs(error) < 0.3 else 0.0), 4.0 * error
        self.publisher.publish(twist)
""",
    "thread_backwards_and_small": """
import threading
import time

class FigureEight(Node):
    def __init__(self):
        Node.__init__(self, "figure_eight")
        self.pub = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.pen = self.create_publisher(Twist, "figure_eight/commands", 10)
        threading.Thread(target=self.drive, daemon=True).start()

    def drive(self):
        while self.pub.get_subscription_count() == 0:
            time.sleep(0.05)
        time.sleep(1.0)
        for sign in (1.0, -1.0):
            twist = Twist()
            twist.linear.x, twist.angular.z = -0.6, sign * 1.2
            end = time.monotonic() + math.tau / 1.2
            while time.monotonic() < end:
                self.pub.publish(twist)
                time.sleep(0.02)
            self.pub.publish(Twist())
            time.sleep(1.5)
""",
    "follows_a_point_on_the_figure": """
class FigureEight(Node):
    RADIUS, SPEED = 2.0, 1.6

    def __init__(self):
        super().__init__("figure_eight")
        self.start, self.s = None, 0.0
        self.pub = self.create_publisher(Twist, "turtle1/cmd_vel", 1)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1)

    def point(self, s):
        around = math.tau * self.RADIUS
        sign, angle = (1, s / self.RADIUS) if s < around else (-1, (s - around) / self.RADIUS)
        x, y = self.RADIUS * math.sin(angle), sign * self.RADIUS * (1 - math.cos(angle))
        c, d = math.cos(self.start.theta), math.sin(self.start.theta)
        heading = self.start.theta + sign * angle
        return self.start.x + c * x - d * y, self.start.y + d * x + c * y, heading, sign

    def on_pose(self, pose):
        if self.start is None:
            self.start = pose
        twist = Twist()
        whole = 2 * math.tau * self.RADIUS
        if self.s < whole:
            self.s = min(whole, self.s + self.SPEED * 0.016)
            x, y, heading, sign = self.point(self.s)
            dx, dy = x - pose.x, y - pose.y
            along = math.cos(pose.theta) * dx + math.sin(pose.theta) * dy
            across = -math.sin(pose.theta) * dx + math.cos(pose.theta) * dy
            twist.linear.x = self.SPEED + 3.0 * along
            error = math.remainder(heading - pose.theta, math.tau)
            twist.angular.z = sign * self.SPEED / self.RADIUS + 4.0 * across + 3.0 * error
        self.pub.publish(twist)
""",
}

ANSWERS = Answers("topics-4", 5, FIGURE_EIGHT, WRONG, STYLES, together=8)
