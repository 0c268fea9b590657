"""Right answers to chapter 3's exercises in other styles, by exercise and style."""

from __future__ import annotations

COUNTDOWN = {
    "event_of_the_match": """
from rclpy.event_handler import PublisherEventCallbacks
from std_msgs.msg import Int32

class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
        self.numbers = iter(range(10, -1, -1))
        self.timer = None
        self.publisher = self.create_publisher(
            Int32, "countdown", 10, event_callbacks=PublisherEventCallbacks(matched=self.on_matched))

    def on_matched(self, status):
        if self.timer is None and status.current_count > 0:
            self.get_logger().info("somebody listens")
            self.timer = self.create_timer(0.2, self.tick)
            self.tick()

    def tick(self):
        try:
            self.publisher.publish(Int32(data=next(self.numbers)))
        except StopIteration:
            self.destroy_timer(self.timer)
""",
    "thread": """
import threading
import time
from std_msgs.msg import Int32

class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
        self.publisher = self.create_publisher(Int32, "/countdown", 1)
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        while not self.publisher.get_subscription_count():
            time.sleep(0.02)
        for number in reversed(range(11)):
            self.publisher.publish(Int32(data=number))
            time.sleep(0.2)
""",
    "async_with_numpy": """
import numpy as np
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.task import Future
from std_msgs.msg import Int32

class Countdown(Node):
    def __init__(self):
        Node.__init__(self, "countdown", namespace="/")
        self.pub = self.create_publisher(Int32, "countdown", 10)
        self.looking = self.create_timer(0.1, self.count)

    async def count(self):
        if self.pub.get_subscription_count() < 1:
            return
        self.looking.cancel()
        for number in np.arange(10, -1, -1):
            self.pub.publish(Int32(data=int(number)))
            await self.pause(0.2)

    def pause(self, seconds):
        over = Future()

        def end():
            timer.cancel()
            over.set_result(None)

        timer = self.create_timer(seconds, end, callback_group=ReentrantCallbackGroup())
        return over
""",
    "looks_each_second_best_effort_other_node": """
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Int32, String

class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
        self.helper = Node("countdown_helper")
        self.state = self.create_publisher(String, "countdown/state", 10)
        self.publisher = self.create_publisher(Int32, "countdown", qos_profile_sensor_data)
        self.left = list(range(11))
        self.start_timer = self.create_timer(0.9, self.look)

    def look(self):
        self.state.publish(String(data="looks"))
        if self.count_subscribers("countdown") and self.publisher.get_subscription_count():
            self.start_timer.cancel()
            self.create_timer(0.2, self.tick)

    def tick(self):
        if self.left:
            self.publisher.publish(Int32(data=self.left.pop()))
""",
    "sleeps_in_a_callback_of_many_threads": """
import time
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import Int32

class Countdown(LifecycleNode):
    def __init__(self, **options):
        super().__init__("countdown", **options)
        self.pub = Node.create_publisher(self, Int32, "countdown", 10)
        self.timer = self.create_timer(0.1, self.count, callback_group=ReentrantCallbackGroup())

    def count(self):
        if self.pub.get_subscription_count() > 0 and not self.timer.is_canceled():
            self.timer.cancel()
            for number in range(10, -1, -1):
                self.pub.publish(Int32(data=number))
                time.sleep(0.2)

countdown = run(Countdown, executor=MultiThreadedExecutor())
""",
}

SCAN_COUNTER = {
    "depth_1": """
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan

class ScanCounter(Node):
    count = 0

    def __init__(self):
        super().__init__("scan_counter")
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.create_subscription(LaserScan, "/scan", self.on_scan, qos)

    async def on_scan(self, scan):
        self.count = self.count + 1
""",
    "system_default_and_numpy": """
import numpy as np
from rclpy.qos import qos_profile_system_default
from sensor_msgs.msg import LaserScan

class ScanCounter(Node):
    def __init__(self):
        Node.__init__(self, "scan_counter")
        self.count = np.int64(0)
        self.subscription = self.create_subscription(LaserScan, "scan", self.cb, qos_profile_system_default)

    def cb(self, msg, info):
        self.count += np.int64(1)
        self.get_logger().debug(f"{self.count}")
""",
    "best_available": """
from rclpy.qos import qos_profile_best_available
from sensor_msgs.msg import LaserScan

class ScanCounter(Node):
    def __init__(self):
        super().__init__("scan_counter")
        self.scans = []
        self.create_subscription(LaserScan, "scan", self.scans.append, qos_profile_best_available)

    @property
    def count(self):
        return len(self.scans)
""",
    "told_of_what_does_not_fit": """
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan

class ScanCounter(Node):
    def __init__(self):
        super().__init__("scan_counter")
        self.count = 0
        events = SubscriptionEventCallbacks(incompatible_qos=self.ask_for_less)
        self.first = self.create_subscription(LaserScan, "scan", self.on_scan, 10, event_callbacks=events)
        self.second = None

    def ask_for_less(self, event):
        if self.second is None:
            qos = QoSProfile(depth=50, reliability=ReliabilityPolicy.BEST_EFFORT)
            self.second = self.create_subscription(LaserScan, "scan", self.on_scan, qos)

    def on_scan(self, scan):
        self.count += 1
""",
}

RELAY = {
    "the_first_of_ten": """
from itertools import cycle
from rclpy.qos import qos_profile_sensor_data

class Relay(Node):
    def __init__(self):
        super().__init__("relay")
        self.turn = cycle([True] + 9 * [False])
        self.slow = self.create_publisher(Pose, "/turtle1/pose_slow", qos_profile_sensor_data)
        self.create_subscription(Pose, "/turtle1/pose", self.relay, qos_profile_sensor_data)

    async def relay(self, pose):
        if next(self.turn):
            self.slow.publish(pose)
""",
    "a_list_made_anew": """
import numpy as np

class Relay(Node):
    def __init__(self):
        Node.__init__(self, "relay")
        self.pub = self.create_publisher(Pose, "turtle1/pose_slow", 1)
        self.kept = []
        self.create_subscription(Pose, "turtle1/pose", self.keep, 1)

    def keep(self, pose):
        self.kept.append(np.array([pose.x, pose.y, pose.theta, pose.linear_velocity, pose.angular_velocity]))
        if len(self.kept) == 10:
            x, y, theta, v, w = map(float, self.kept[-1])
            self.pub.publish(Pose(x=x, y=y, theta=theta, linear_velocity=v, angular_velocity=w))
            self.kept.clear()
""",
    "publisher_at_the_first_pose": """
class Relay(Node):
    publisher = None
    number = 4

    def __init__(self):
        super().__init__("relay")
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)

    def on_pose(self, pose, info):
        if self.publisher is None:
            self.publisher = self.create_publisher(Pose, "turtle1/pose_slow", 10)
        self.number = (self.number + 1) % 10
        if self.number == 0:
            self.publisher.publish(pose)
""",
    "threads_and_a_queue": """
import queue
import threading
from rclpy.executors import MultiThreadedExecutor

class Relay(Node):
    def __init__(self):
        super().__init__("relay")
        self.publisher = self.create_publisher(Pose, "turtle1/pose_slow", 10)
        self.poses = queue.Queue()
        self.create_subscription(Pose, "turtle1/pose", self.poses.put, 10)
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        while True:
            for _ in range(9):
                self.poses.get()
            self.publisher.publish(self.poses.get())

relay = run(Relay, executor=MultiThreadedExecutor())
""",
}
