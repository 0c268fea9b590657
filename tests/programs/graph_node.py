"""A node of its own process for the tests of the graph: does what it is told, one line of Python at a time.

Lines know `node`, `rclpy`, `String`, `Int32`, `QoSProfile`, `best_effort` and `latched`; each is answered by "done".
"""

from __future__ import annotations

import contextlib
import sys
import threading

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger
from turtlesim.action import RotateAbsolute

rclpy.init()
node = rclpy.create_node(sys.argv[1], namespace=sys.argv[2])
executor = SingleThreadedExecutor()
best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
latched = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
KNOWN = (ActionClient, ActionServer, Int32, String, Trigger, RotateAbsolute)


def spin() -> None:
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(node, executor)


spinning = threading.Thread(target=spin)
spinning.start()
print("done", flush=True)
for line in sys.stdin:
    executor.create_task(exec, line, globals()).add_done_callback(lambda _: print("done", flush=True))
rclpy.shutdown()
spinning.join()
