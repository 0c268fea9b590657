"""Answers to topics-1: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked
from tests.exercises.topics import styles

COUNTDOWN = worked("topics-1")

BURSTS = """
from std_msgs.msg import Int32

class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
        self.publisher = self.create_publisher(Int32, "countdown", 20)
        self.timer = self.create_timer(1.0, self.tick)
        self.left = 10

    def tick(self):
        if self.publisher.get_subscription_count():
            for _ in range(5):
                if self.left >= 0:
                    self.publisher.publish(Int32(data=self.left))
                    self.left -= 1
"""

FOR_EACH_LISTENER = """
from rclpy.event_handler import PublisherEventCallbacks
from std_msgs.msg import Int32

class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
        self.left, self.timer = -1, None
        self.publisher = self.create_publisher(
            Int32, "countdown", 10, event_callbacks=PublisherEventCallbacks(matched=self.on_matched))

    def on_matched(self, status):
        if status.current_count_change > 0 and self.left < 0:
            self.left = 10
            self.timer = self.create_timer(0.2, self.tick)

    def tick(self):
        self.publisher.publish(Int32(data=self.left))
        self.left -= 1
        if self.left < 0:
            self.timer.cancel()
"""

CATCHES_UP = changed(
    COUNTDOWN,
    ("timer(0.2,", "timer(0.02,"),
    ("self.left = 10", "self.left, self.ticks = 10, 0"),
    ("    def tick(self):\n", "    def tick(self):\n        self.ticks += 1\n"),
    ("count() == 0:", "count() == 0 or self.ticks < 10 * (10 - self.left):"),
)

LISTENS = "self.publisher.get_subscription_count() == 0"  # of COUNTDOWN: none does


ANSWERS = Answers(
    "topics-1",
    2,
    COUNTDOWN,
    [
        Wrong(
            "type",
            changed(COUNTDOWN, ("Int32", "String"), ("data=self.left", "data=str(self.left)")),
            0,
            "Its type is std_msgs/msg/String",
        ),
        Wrong("at_once", changed(COUNTDOWN, ("== 0", "< 0")), 1, "before a subscription has matched is lost"),
        Wrong("goes_on", changed(COUNTDOWN, ("self.timer.cancel()", "pass")), 1, "It goes on after 0"),
        Wrong("slow", changed(COUNTDOWN, ("0.2, self", "0.4, self")), 1, "It was 2.5 Hz"),
        Wrong("topic", changed(COUNTDOWN, ('"countdown", 10', '"count_down", 10')), 0, "Did you mean `/count_down`?"),
        Wrong(
            "node_of_another",
            changed(COUNTDOWN, ('__init__("countdown")', '__init__("talker")')),
            0,
            "Your node is called /talker",
        ),
        Wrong(
            "up",
            changed(COUNTDOWN, ("left = 10", "left = 0"), ("left -= 1", "left += 1"), ("left < 0", "left > 10")),
            1,
            "It counts up",
        ),
        Wrong("no_node", "class Countdown:\n    pass\n", 0, "Write: class Countdown(Node)"),
        Wrong("raises", changed(COUNTDOWN, ("self.left = 10", "self.left = ten")), 0, "name 'ten' is not defined"),
        Wrong(
            "callback_raises",
            changed(COUNTDOWN, ("data=self.left", "data=str(self.left)")),
            0,
            "The 'data' field must be of type 'int'",
        ),
        *(
            # That many ticks, 0.2 s each, in place of a listener.
            Wrong(
                f"waits_{ticks}_ticks",
                changed(
                    COUNTDOWN,
                    (f"if {LISTENS}:", f"self.ticks += 1\n        if self.ticks < {ticks}:"),
                    ("self.left = 10", "self.left, self.ticks = 10, 0"),
                ),
                1,
                "get_subscription_count()",
            )
            for ticks in (4, 9, 15, 18)
        ),
        Wrong(
            "of_the_class",
            changed(
                COUNTDOWN,
                ("    def __init__", "    left = 10\n\n    def __init__"),
                ("self.left = 10", "pass"),
                ("self.left", "Countdown.left"),
            ),
            1,
            "each new node",
        ),
        Wrong(
            "ten_to_nobody",
            changed(
                COUNTDOWN, (f"if {LISTENS}:", f"if {LISTENS}:\n            self.publisher.publish(Int32(data=10))")
            ),
            1,
            "before somebody listens",
        ),
        Wrong("five_at_once", BURSTS, 1, "unevenly"),
        Wrong("for_each_listener", FOR_EACH_LISTENER, 1, "counts again for who comes later"),
        Wrong("back_to_10", changed(FOR_EACH_LISTENER, (" and self.left < 0", "")), 1, "counts again for who comes"),
        Wrong(
            "for_each_listener_and_delayed_once",  # as by a busy machine: that count is taken again
            changed(
                FOR_EACH_LISTENER,
                ("class Countdown", "import time\ndelays = [0.0, 1.0]\n\nclass Countdown"),
                (
                    "        self.left -= 1\n",
                    "        self.left -= 1\n        time.sleep(delays.pop() if delays else 0)\n",
                ),
            ),
            1,
            "counts again for who comes later",
        ),
        Wrong(
            "again_after_a_second",
            changed(
                COUNTDOWN,
                ("self.left < 0", "self.left < -5"),
                ("self.timer.cancel()", "self.left = 10"),
                ("        self.publisher.p", "        if self.left >= 0:\n            self.publisher.p"),
            ),
            1,
            "It goes on after 0",
        ),
        Wrong(
            "zero_again_later",
            changed(
                COUNTDOWN,
                ("self.left < 0", "self.left < -8"),
                (
                    "        self.publisher.publish(Int32(data=self.left))",
                    "        if self.left >= 0 or self.left == -6:\n"
                    "            self.publisher.publish(Int32(data=max(0, self.left)))",
                ),
            ),
            1,
            "It goes on after 0",
        ),
        Wrong("catches_up", CATCHES_UP, 1, "5 messages a second (0 of 1 point)"),
        Wrong(
            "each_node_slower",
            changed(
                COUNTDOWN,
                ("    def __init__", "    period = 0.05\n\n    def __init__"),
                ("timer(0.2,", "timer(self.period,"),
                ("self.left = 10", "self.left = 10\n        Countdown.period += 0.15"),
            ),
            1,
            "in one of two counts",
        ),
        Wrong("without_0", changed(COUNTDOWN, ("left < 0", "left < 1")), 1, "each once"),
    ],
    styles.COUNTDOWN,
    together=16,
)
