"""Answers to workspace-4: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, solved, worked

BATTERY, RECHARGE = solved("workspace-4").files.values()


def types(battery: str = BATTERY, recharge: str = RECHARGE) -> str:
    return f"interfaces({battery!r}, {recharge!r})\n"


CHARGER_CLASS = f"\n{solved('workspace-4').cells[-1]}\n"
CHARGER = types() + CHARGER_CLASS
SET_ALL_THE_SAME = changed(
    CHARGER,
    (
        "        if response.accepted:\n            self.battery.percentage = request.percentage\n        else:",
        "        self.battery.percentage = request.percentage\n        if not response.accepted:",
    ),
)
CLAMPED = changed(
    SET_ALL_THE_SAME,
    ("self.battery.percentage = request.percentage", "self.battery.percentage = min(request.percentage, 100.0)"),
)
# Less and less, and anew when it is empty; numpy's numbers, a lock, a group for what may run at the same time.
CAPACITOR = (
    types()
    + """
import threading
import numpy as np
from rclpy.callback_groups import ReentrantCallbackGroup
from robot_interfaces.msg import Battery
from robot_interfaces.srv import Recharge


class Charger(Node):
    def __init__(self, **options):
        Node.__init__(self, "charger", **options)
        self.charge, self.lock, group = np.float32(80.0), threading.Lock(), ReentrantCallbackGroup()
        self.out = self.create_publisher(Battery, "/battery", 1)
        self.timer = self.create_timer(1, self.publish_battery, callback_group=group)
        self.service = self.create_service(Recharge, "/recharge", self.on_recharge, callback_group=group)

    def publish_battery(self):
        with self.lock:
            self.charge *= np.float32(0.9)
            if self.charge < 0.5:
                self.charge = np.float32(100)
            self.out.publish(Battery(voltage=float(11.0 + self.charge / 50.0), percentage=float(self.charge)))

    def on_recharge(self, request, _):
        if not 0.0 <= request.percentage <= 100.0:
            return Recharge.Response(accepted=False, reason=f"{request.percentage:.0f} % cannot be")
        with self.lock:
            self.charge = np.float32(request.percentage)
        return Recharge.Response(accepted=True, reason="charged")
"""
)
# By the clock, with a helper node that publishes, and an async service.
BY_THE_CLOCK = (
    types()
    + """
from robot_interfaces.msg import Battery
from robot_interfaces.srv import Recharge


class Counter(Node):
    def __init__(self):
        super().__init__("charger")
        self.full_at, self.level = self.get_clock().now(), 100.0

    @property
    def now(self):
        return max(0.0, self.level - 2.0 * (self.get_clock().now() - self.full_at).nanoseconds / 1e9)


class Charger(Counter):
    def __init__(self):
        super().__init__()
        self.helper = Node("charger_service")
        self.publisher = self.create_publisher(Battery, "battery", 10)
        self.create_timer(1.0, lambda: self.publisher.publish(Battery(percentage=self.now)))
        self.create_service(Recharge, "recharge", self.recharge)

    async def recharge(self, request, response):
        match request.percentage:
            case percentage if percentage > 100:
                response.reason = "no"
            case percentage:
                self.full_at, self.level, response.accepted = self.get_clock().now(), percentage, True
        return response
"""
)

ANSWERS = Answers(
    "workspace-4",
    4,
    f"leave_out('robot_interfaces')\n{worked('workspace-4')}",
    [
        Wrong(
            "definitions",
            types(BATTERY.replace("float32 percentage", "int32 percentage"), RECHARGE.replace("accepted", "ok")),
            0,
            "It says: float32 EMPTY_VOLTAGE=11.0 / float32 voltage / int32 percentage",
        ),
        Wrong("not_less", changed(CHARGER, ("percentage -= 0.5", "percentage -= 0.0")), 3, "less than before"),
        Wrong("accepts_all", changed(CHARGER, ("request.percentage <= 100.0", "True")), 3, "accepted=True, reason=''"),
        Wrong(
            "topic_type",
            changed(
                CHARGER,
                ('(Battery, "battery", 10)', '(String, "battery", 10)'),
                ("from robot_interfaces.srv", "from std_msgs.msg import String\nfrom robot_interfaces.srv"),
                ("publish(self.battery)", "publish(String())"),
            ),
            2,
            "Its type is std_msgs/msg/String",
        ),
        Wrong("no_reason", changed(CHARGER, ('"more than full"', '""')), 3, "What is refused has a reason"),
        Wrong("full_refused", changed(CHARGER, ("<= 100.0", "< 100.0")), 3, "To 100 % it answered accepted=False"),
        Wrong("set_all_the_same", SET_ALL_THE_SAME, 3, "what is refused is not"),
        Wrong("clamped", CLAMPED, 3, "what is refused is not"),
        Wrong(
            "not_set",
            changed(CHARGER, ("self.battery.percentage = request.percentage", "pass")),
            3,
            "What is accepted is set",
        ),
        Wrong(
            "stops_after_recharge",
            changed(
                CHARGER,
                ("= request.percentage\n", "= request.percentage\n            self.step = 0.0\n"),
                ("percentage -= 0.5", 'percentage -= getattr(self, "step", 0.5)'),
            ),
            3,
            "in steps as before",
        ),
        Wrong(
            "big_step_after",
            changed(
                CHARGER,
                ("= request.percentage\n", "= request.percentage\n            self.step = 9.0\n"),
                ("percentage -= 0.5", 'percentage -= getattr(self, "step", 0.5)'),
            ),
            3,
            "in steps as before",
        ),
        Wrong(
            "truncates",
            changed(CHARGER, ("= request.percentage\n", "= float(int(request.percentage))\n")),
            3,
            "What is accepted is set",
        ),
        Wrong(
            "publishes_at_recharge",
            changed(
                CHARGER,
                (
                    "        return response",
                    "        self.publisher.publish(self.battery)\n        return response",
                ),
            ),
            3,
            "only the timer publishes",
        ),
        Wrong(
            "too_often",
            changed(CHARGER, ("create_timer(1.0", "create_timer(0.5")),
            3,
            "times a second: a timer with a period of 1.0 s",
        ),
    ],
    {"capacitor": CAPACITOR, "by_the_clock": BY_THE_CLOCK},
    together=8,
)
