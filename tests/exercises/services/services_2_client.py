"""Answers to services-2: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

SAFE_CLIENT = worked("services-2")

KEEPS_SUMS = changed(
    SAFE_CLIENT,
    ('_two_ints")\n', '_two_ints")\n        self.sums = {}\n'),
    ("        end = ", "        if (a, b) in self.sums:\n            return self.sums[a, b]\n        end = "),
    ("            return wait_for", "            self.sums[a, b] = wait_for"),
    (".sum\n", ".sum\n            return self.sums[a, b]\n"),
)


def first(line: str) -> str:
    """The solution, with a line at the beginning of add()."""
    return changed(SAFE_CLIENT, ("        end = ", f"        {line}\n        end = "))


BY_EVENT = """
import threading, time

class SafeClient(Node):
    def __init__(self):
        Node.__init__(self, "safe_client")
        self.adder = self.create_client(AddTwoInts, "/add_two_ints")

    def add(self, a, b, timeout):
        until = time.perf_counter() + timeout
        while not self.adder.service_is_ready():
            if time.perf_counter() >= until:
                return None
            time.sleep(0.01)
        arrived = threading.Event()
        asked = self.adder.call_async(AddTwoInts.Request(a=a, b=b))
        asked.add_done_callback(lambda _: arrived.set())
        try:
            return asked.result().sum if arrived.wait(max(0.0, until - time.perf_counter())) else None
        finally:
            self.adder.remove_pending_request(asked)
"""

BY_CALL = """
from time import monotonic
from rclpy.lifecycle import LifecycleNode

class SafeClient(LifecycleNode):
    def __init__(self):
        super().__init__("safe_client")
        self.client = self.create_client(AddTwoInts, "add_two_ints")

    def add(self, a, b, timeout):
        began = monotonic()
        self.client.wait_for_service(timeout)
        left = timeout - (monotonic() - began)
        response = self.client.call(AddTwoInts.Request(a=a, b=b), timeout_sec=max(left, 0.0))
        return response and response.sum
"""

BY_POLLING = """
import time
import numpy as np

class SafeClient(Node):
    def __init__(self):
        super().__init__("safe_client")
        self.client = self.create_client(AddTwoInts, "add_two_ints")

    def add(self, a, b, timeout):
        if not self.client.service_is_ready():  # who is not there when the call comes is not waited for
            return None
        end = time.time() + timeout
        future = self.client.call_async(AddTwoInts.Request(a=a, b=b))
        while time.time() < end:
            if future.done():
                return np.int64(future.result().sum)
            time.sleep(0.005)
        future.cancel()

safe_client = run(SafeClient)
"""

CLIENT_PER_CALL = """
import time

class SafeClient(Node):
    def __init__(self):
        super().__init__("safe_client")

    def add(self, a, b, timeout):
        end = time.monotonic() + timeout
        client = self.create_client(AddTwoInts, "add_two_ints")
        try:
            while not client.service_is_ready() and time.monotonic() < end:
                time.sleep(0.02)
            future = client.call_async(AddTwoInts.Request(a=a, b=b))
            return wait_for(future, timeout=end - time.monotonic()).sum
        except TimeoutError:
            return None
        finally:
            self.destroy_client(client)
"""

# As in a program: a node of its own that nobody else spins.
OWN_SPINNING = """
import time
import rclpy

class SafeClient(Node):
    def __init__(self):
        super().__init__("safe_client")
        self.asker = rclpy.create_node("safe_client_asker")
        self.client = self.asker.create_client(AddTwoInts, "add_two_ints")

    def add(self, a, b, timeout):
        end = time.monotonic() + timeout
        if self.client.wait_for_service(timeout_sec=timeout):
            future = self.client.call_async(AddTwoInts.Request(a=a, b=b))
            rclpy.spin_until_future_complete(self.asker, future, timeout_sec=max(0.0, end - time.monotonic()))
            if future.done():
                return future.result().sum
            self.client.remove_pending_request(future)
        return None
"""

BY_NUMBER = """
import time

class SafeClient(Node):
    def __init__(self):
        super().__init__("safe_client")
        self.client = self.create_client(AddTwoInts, "add_two_ints")
        self.calls = 0

    def add(self, a, b, timeout):
        self.calls += 1
        if self.calls in (1, 2, 3, 5):
            self.client.call(AddTwoInts.Request(a=a, b=b), timeout_sec=1.0)
            return a + b
        time.sleep(timeout)
"""

ANSWERS = Answers(
    "services-2",
    2,
    SAFE_CLIENT,
    [
        Wrong("raises", changed(SAFE_CLIENT, ("except TimeoutError:", "except ValueError:")), 1, "TimeoutError"),
        Wrong("hangs", changed(SAFE_CLIENT, ("timeout_sec=timeout", "")), 1, "s: it waits for what never comes"),
        Wrong(
            "constructor_hangs",
            changed(
                SAFE_CLIENT,
                ('"add_two_ints")\n', '"add_two_ints")\n        self.client.wait_for_service()\n'),
            ),
            0,
            "The constructor of SafeClient did not return",
        ),
        Wrong(
            "no_wait_for_service",
            changed(
                SAFE_CLIENT,
                ("if not self.client.wait_for_service(timeout_sec=timeout):", "if False:"),
                ("            self.client.remove_pending_request(future)\n", ""),
            ),
            1,
            "futures still wait in the client",
        ),
        Wrong(
            "leaves_future",
            changed(SAFE_CLIENT, ("            self.client.remove_pending_request(future)\n", "")),
            1,
            "1 futures still wait",
        ),
        Wrong(
            "fixed_timeout",
            changed(SAFE_CLIENT, ("timeout_sec=timeout", "timeout_sec=2.0"), ("end - time.monotonic()", "2.0")),
            1,
            "`timeout` is for both waits together",
        ),
        Wrong(
            "fixed_timeout_of_one_wait",
            changed(SAFE_CLIENT, ("timeout_sec=timeout", "timeout_sec=1.0")),
            1,
            "s without a server: `timeout` is for both waits together",
        ),
        Wrong(
            "each_wait_gets_it_all",
            changed(SAFE_CLIENT, ("end - time.monotonic()", "timeout")),
            1,
            "with a server that came in the middle of the timeout",
        ),
        Wrong(
            "each_wait_gets_it_all_by_call",
            changed(BY_CALL, ("max(left, 0.0)", "timeout")),
            1,
            "`timeout` is for both waits together",
        ),
        Wrong(
            "each_wait_gets_half",
            changed(SAFE_CLIENT, ("=timeout", "=timeout / 2"), ("end - time.monotonic()", "timeout / 2")),
            1,
            "wait for the future as long as `timeout` allows",
        ),
        Wrong(
            "zero",
            changed(SAFE_CLIENT, ("            return None\n        future", "            return 0\n        future")),
            1,
            "It returned 0 without a server",
        ),
        Wrong(
            "zero_is_none",
            changed(BY_CALL, ("return response and response.sum", "return response and response.sum or None")),
            1,
            "answered 0 after",
        ),
        Wrong(
            "adds_itself",
            changed(SAFE_CLIENT, ("return wait_for(", "_ = wait_for("), (".sum\n", ".sum\n            return a + b\n")),
            1,
            "too much, answered",
        ),
        Wrong(
            "the_last_sum",
            changed(
                SAFE_CLIENT,
                ("            return wait_for", "            self.last = wait_for"),
                ("(future)\n            return None", "(future)\n        return self.last"),
            ),
            1,
            "with a server that did not answer, and not None",
        ),
        Wrong("by_number", BY_NUMBER, 0, "wait for the future"),
        Wrong("timeout_by_heart", first("timeout = 0.7"), 1, "wait for the future"),
        Wrong("timeout_at_most_1", first("timeout = min(timeout, 1.0)"), 1, "wait for the future"),
        Wrong("whole_seconds", first("timeout = int(timeout)"), 1, "wait for the future"),
        Wrong("keeps_sums", KEEPS_SUMS, 1, "with a server that did not answer, and not None"),
        Wrong(
            "gives_up",
            changed(
                first("if self.client is None:\n            return None"),
                (
                    "            return None\n        future",
                    "            self.client = None\n            return\n        future",
                ),
            ),
            1,
            "asks again",
        ),
        Wrong(
            "future",
            changed(SAFE_CLIENT, ("wait_for(future, timeout=end - time.monotonic()).sum", "future")),
            0,
            "is no plain value",
        ),
    ],
    {
        "event": BY_EVENT,
        "call": BY_CALL,
        "polling": BY_POLLING,
        "client_per_call": CLIENT_PER_CALL,
        "own_spinning": OWN_SPINNING,
        "threads": f"{SAFE_CLIENT}\nfrom rclpy.executors import MultiThreadedExecutor\n"
        "safe_client = run(SafeClient, executor=MultiThreadedExecutor())\n",
    },
)
