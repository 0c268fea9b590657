"""Answers to setup-2: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

GREETER = "\nstop()" + worked("setup-2")
SILENT = """
import time; time.sleep(0.5)

class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")

greeter = run(Greeter)
"""
OTHER_SAYS_IT = """
stop()

class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")

class Friend(Node):
    def __init__(self):
        super().__init__("friend")
        self.get_logger().info("Nice to meet you, Ada")

greeter, friend = run(Greeter), run(Friend)
"""
MUCH_LATER = """
stop()

class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")
        self.get_logger().info("Starting.")
        self.create_timer(10.0, lambda: self.get_logger().info("Nice to meet you, Ada"))

greeter = run(Greeter)
"""
GREETERS = {
    "after_others_and_later": """
stop()

class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")
        self.get_logger().info("Starting.")
        self.timer = self.create_timer(1.8, self.greet)

    def greet(self):
        self.timer.cancel()
        self.get_logger().debug("About to greet.")
        self.get_logger().info("Nice to meet you, Ada Lovelace!")
        self.get_logger().warning("That was all.")

greeter = run(Greeter)
""",
    "child_logger": """
from rclpy.lifecycle import LifecycleNode
stop()

class Greeter(LifecycleNode):
    def __init__(self, **options):
        LifecycleNode.__init__(self, "greeter", **options)
        logger = self.get_logger().get_child("manners")
        logger.info("Nice to meet you, 李雷", once=True)

greeter = run(Greeter())
""",
    "repeats_it": """
from rclpy.executors import MultiThreadedExecutor
stop()

class Greeter(Node):
    def __init__(self, name):
        super().__init__("greeter")
        self.declare_parameter("who", name)
        self.get_logger().warning("Nice to meet you, nobody yet")
        self.create_timer(0.05, self.greet)
        self.create_timer(0.01, lambda: self.get_logger().info("busy"))

    def greet(self):
        self.get_logger().info(f"Nice to meet you, {self.get_parameter('who').value}")

greeter = run(Greeter, "R2-D2", executor=MultiThreadedExecutor())
""",
    "first_of_many": """
stop()

class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")
        self.get_logger().info("Nice to meet you, Grace")
        for number in range(300):
            self.get_logger().info(f"line {number}")

greeter = run(Greeter)
""",
}

ANSWERS = Answers(
    "setup-2",
    2,
    GREETER,
    [
        Wrong("print", changed(GREETER, ("self.get_logger().info(", "print(")), 1, "print() goes to nobody else"),
        Wrong("no_name", changed(GREETER, ("you, Ada", "you, <your name>")), 1, "where `<your name>` stands"),
        Wrong("level", changed(GREETER, ("info(", "warning(")), 1, "the level is not INFO"),
        Wrong("node_name", changed(GREETER, ('__init__("greeter")', '__init__("hello")')), 0, "Running: /hello"),
        Wrong("not_run", changed(GREETER, ("greeter = run(Greeter)\n", "")), 0, "Start it with `run(Greeter"),
        Wrong(
            "text",
            changed(GREETER, ("Nice to meet you, Ada", "Hello, Ada")),
            1,
            "It logged 'Hello, Ada'. The line is",
        ),
        Wrong("right_before", GREETER + SILENT, 1, "It logged nothing"),
        Wrong("no_f", changed(GREETER, ("you, Ada", "you, {name}")), 1, "Put an f before the quotes"),
        Wrong("unset_name", changed(GREETER, ('"Nice to meet you, Ada"', 'f"Nice to meet you, {None}"')), 1, "None'"),
        Wrong("no_comma", changed(GREETER, ("you, Ada", "you Ada")), 1, "the comma behind `you` is missing"),
        *(
            Wrong(name, changed(GREETER, ("Nice to meet you, Ada", text)), 1, f"It logged '{text}'. The line is")
            for name, text in {
                "small": "nice to meet you, Ada",
                "after_hello": "Hello! Nice to meet you, Ada",
                "in_brackets": "Nice to meet you, <Ada>",
            }.items()
        ),
        Wrong("nobody", changed(GREETER, ("you, Ada", "you, ")), 1, "and then a name"),
        Wrong("another_says_it", OTHER_SAYS_IT, 1, "It logged nothing"),
        Wrong("stopped", GREETER + "\nwait_for(lambda: logs('greeter'))\nstop(greeter)\n", 0, "No node runs"),
        Wrong("much_later", MUCH_LATER, 1, "It logged 'Starting.'"),
    ],
    GREETERS,
)
