"""Answers to workspace-2: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, solved, worked
from tests.exercises.workspace.cells import PYTHON

LOUD_PY = "\n" + solved("workspace-2").files["ros2_ws/src/greeter/greeter/loud.py"]


def loud(text: str = LOUD_PY, programs: str = '["loud"]', after: str = "", build: str = "") -> str:
    """The cell that makes greeter with a file loud.py, builds it, and then does something else."""
    return f"""
fresh("greeter", {PYTHON}, programs={programs}, files={{"greeter/loud.py": {text!r}}})
build("greeter"{build})
{after}
"""


EDITED = """
path = ws.src / "greeter/greeter/loud.py"
path.write_text(path.read_text().replace("mark))", "mark + mark))"))
"""
READ_ONCE = changed(
    LOUD_PY,
    ('self.declare_parameter("mark", "!")', 'self.mark = self.declare_parameter("mark", "!").value'),
    ('mark = self.get_parameter("mark").value', "mark = self.mark"),
)
PLAIN_SPIN = changed(
    LOUD_PY,
    ("from my_first_pkg.spin import spin", "import rclpy"),
    ("    spin(Loud)", "    rclpy.init()\n    rclpy.spin(Loud())\n    rclpy.shutdown()"),
)
SKIPS_REPEATS = changed(
    LOUD_PY,
    (
        "        mark =",
        '        if message.data == getattr(self, "last", None):\n            return\n'
        "        self.last = message.data\n        mark =",
    ),
)
# The command line does not get in.
NO_ARGUMENTS = changed(
    PLAIN_SPIN,
    ("    rclpy.init()\n    rclpy.spin(Loud())", "    rclpy.init(args=[])\n    try:\n        rclpy.spin(Loud())"),
    (
        "    rclpy.shutdown()",
        "    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):\n        pass",
    ),
)
SAYS_BOTH = changed(LOUD_PY, ("        mark =", "        self.publisher.publish(message)\n        mark ="))
MARK_IN_CAPITALS = changed(LOUD_PY, ("message.data.upper() + mark", "(message.data + mark).upper()"))
NEVER_EMPTY = changed(LOUD_PY, ('get_parameter("mark").value', 'get_parameter("mark").value or "!"'))
GOES_ON = changed(
    PLAIN_SPIN,
    ("    rclpy.init()", "    import signal\n\n    rclpy.init()\n    signal.signal(signal.SIGINT, signal.SIG_IGN)"),
)
# The mark is kept by a callback; a lifecycle node, with an executor of its own and other QoS.
BY_CALLBACK = """
import sys

import rclpy
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String


class Loud(LifecycleNode):
    def __init__(self):
        LifecycleNode.__init__(self, "loud")
        self.add_on_set_parameters_callback(self.keep)
        self.declare_parameter("mark", "!", ParameterDescriptor(description="what comes last"))
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.out = self.create_publisher(String, "loud", QoSProfile(depth=1))
        self.log = self.create_publisher(String, "~/log", 10)
        self.create_subscription(String, "chatter", self.on_words, qos)

    def keep(self, parameters):
        for parameter in parameters:
            if parameter.name == "mark":
                self.mark = parameter.value
        return SetParametersResult(successful=True)

    def on_words(self, message):
        message.data = "".join([letter.upper() for letter in message.data]) + self.mark
        self.out.publish(message)
        self.log.publish(String(data="said"))


def main(args=None):
    rclpy.init(args=args)
    executor, node = MultiThreadedExecutor(2), Loud()
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
"""
# No class, a loop of its own, an async callback.
WITHOUT_CLASS = """
import rclpy
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String


def main():
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("loud", automatically_declare_parameters_from_overrides=True)
    if not node.has_parameter("mark"):
        node.declare_parameter("mark", "!")
    out = node.create_publisher(String, "loud", 10)

    async def shout(message):
        out.publish(String(data="{}{}".format(message.data.upper(), node.get_parameter("mark").value)))

    node.create_subscription(String, "chatter", shout, 10)
    try:
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=0.1)
    except KeyboardInterrupt:
        node.get_logger().info("Good bye.")
    rclpy.shutdown()
"""

ANSWERS = Answers(
    "workspace-2",
    3,
    f"make('greeter', {PYTHON})\n{worked('workspace-2')}",
    [
        Wrong("no_entry_point", loud(programs="[]"), 0, "a line `loud = greeter.module:main`"),
        Wrong("not_built_again", loud(after=EDITED), 0, "src/greeter/greeter/loud.py is newer than"),
        Wrong("read_once", loud(READ_ONCE), 2, "Read the parameter each time"),
        Wrong("not_declared", loud(changed(LOUD_PY, ('        self.declare_parameter("mark", "!")\n', ""))), 0, "mark"),
        Wrong("not_upper", loud(changed(LOUD_PY, (".upper()", ".title()"))), 0, "the words are not: `message"),
        Wrong("strip", loud(changed(LOUD_PY, (".upper()", ".strip().upper()"))), 2, "whatever is in it"),
        Wrong(
            "skips_empty",
            loud(
                changed(LOUD_PY, ("        mark =", "        if not message.data:\n            return\n        mark ="))
            ),
            2,
            "whatever is in it",
        ),
        Wrong("skips_repeats", loud(SKIPS_REPEATS), 2, "or the same again"),
        Wrong("no_arguments", loud(NO_ARGUMENTS), 2, "Declare the parameter, and give `args`"),
        Wrong("plain_spin", loud(PLAIN_SPIN), 2, "Ctrl-C ended it with status"),
        Wrong("says_both", loud(SAYS_BOTH), 0, "once for each message"),
        Wrong("mark_in_capitals", loud(MARK_IN_CAPITALS), 1, "the mark as it is"),
        Wrong("never_empty", loud(NEVER_EMPTY), 2, "An empty text is a mark too"),
        Wrong("goes_on", loud(GOES_ON), 2, "Ctrl-C did not end it"),
    ],
    {
        "by_callback": loud(BY_CALLBACK, build=', "--symlink-install"'),
        "without_class": loud(WITHOUT_CLASS),
    },
    together=10,
)
