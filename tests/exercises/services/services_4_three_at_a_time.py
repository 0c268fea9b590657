"""Answers to services-4: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

PARALLEL = worked("services-4")

PARALLEL_ASYNC = """
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.task import Future

class ParallelServer(Node):
    def __init__(self):
        super().__init__("add_two_ints_server")
        self.group = ReentrantCallbackGroup()
        self.create_service(AddTwoInts, "add_two_ints", self.add, callback_group=self.group)

    async def add(self, request, response):
        slept = Future()
        timer = self.create_timer(0.3, lambda: slept.set_result(None), callback_group=self.group)
        await slept
        self.destroy_timer(timer)
        response.sum = request.a + request.b
        return response
"""

PARALLEL_SUBCLASS = """
import time
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor

class AddTwoIntsServer(Node):
    def __init__(self):
        super().__init__("add_two_ints_server")
        self.service = self.create_service(AddTwoInts, "add_two_ints", self.add)

    def add(self, request, response):
        response.sum = request.a + request.b
        self.get_logger().info(f"{request.a} + {request.b} = {response.sum}")
        return response

class SlowServer(AddTwoIntsServer):
    def add(self, request, response):
        time.sleep(0.3)
        return super().add(request, response)

class ParallelServer(SlowServer):
    def create_service(self, *args, **options):
        options.setdefault("callback_group", ReentrantCallbackGroup())
        return super().create_service(*args, **options)

server = run(ParallelServer, executor=MultiThreadedExecutor(num_threads=4))
"""

PARALLEL_MADE_AGAIN = """
import threading
from rclpy.callback_groups import ReentrantCallbackGroup

class ParallelServer(Node):
    def __init__(self):
        super().__init__("add_two_ints_server")
        self.service = self.create_service(AddTwoInts, "add_two_ints", self.add)
        self.destroy_service(self.service)
        self._default_callback_group = ReentrantCallbackGroup()
        self.service = self.create_service(AddTwoInts, "add_two_ints", self.add)
        self.lock, self.served = threading.Lock(), 0

    def add(self, request, response):
        threading.Event().wait(0.3)
        with self.lock:
            self.served += 1
        return AddTwoInts.Response(sum=request.a + request.b)
"""

ANSWERS = Answers(
    "services-4",
    3,
    PARALLEL,
    [
        Wrong("one_group", changed(PARALLEL, (", callback_group=group", "")), 2, "MutuallyExclusiveCallbackGroup"),
        Wrong("no_work", changed(PARALLEL, ("        time.sleep(0.3)\n", "")), 2, "keeps the time.sleep(0.3)"),
        Wrong("wrong_sum", changed(PARALLEL, ("request.a + request.b", "request.a")), 2, "What belongs to one request"),
        Wrong(
            "shared_state",
            changed(
                PARALLEL,
                (
                    "        time.sleep(0.3)\n        response.sum = request.a + request.b",
                    "        self.last = request.a + request.b\n        time.sleep(0.3)\n        response.sum = "
                    "self.last",
                ),
            ),
            2,
            "stays in local variables",
        ),
        Wrong(
            "name",
            changed(PARALLEL, ('__init__("add_two_ints_server")', '__init__("parallel_server")')),
            0,
            "Your node is called /parallel_server",
        ),
        Wrong(
            "lock",
            changed(
                PARALLEL,
                (
                    "        group =",
                    "        import threading\n        self.lock = threading.Lock()\n        group =",
                ),
                ("        time.sleep(0.3)\n", "        with self.lock:\n            time.sleep(0.3)\n"),
            ),
            2,
            "such as a lock that is held while it sleeps",
        ),
        Wrong(
            "two_at_a_time",
            changed(
                PARALLEL,
                (
                    "        group =",
                    "        import threading\n        self.two = threading.Semaphore(2)\n        group =",
                ),
                ("        time.sleep(0.3)\n", "        with self.two:\n            time.sleep(0.3)\n"),
            ),
            2,
            "one waited for another",
        ),
        Wrong(
            "own_exclusive_group",
            changed(PARALLEL, ("ReentrantCallbackGroup", "MutuallyExclusiveCallbackGroup")),
            2,
            "Give the service a ReentrantCallbackGroup",
        ),
        Wrong(
            "async_in_one_group",
            changed(PARALLEL_ASYNC, ("self.add, callback_group=self.group", "self.add")),
            2,
            "Give the service a ReentrantCallbackGroup",
        ),
        Wrong(
            "sleeps_once_for_several",
            changed(
                PARALLEL,
                ("        group =", "        self.end = 0.0\n        group ="),
                (
                    "        time.sleep(0.3)\n",
                    "        if self.end < time.monotonic():\n            self.end = time.monotonic() + 0.3\n"
                    "        time.sleep(max(0.0, self.end - time.monotonic()))\n",
                ),
            ),
            2,
            "The quickest took 0.",
        ),
        Wrong("ignores_b", changed(PARALLEL, ("request.a + request.b", "request.a + 10")), 2, "gave"),
        Wrong("too_slow", changed(PARALLEL, ("sleep(0.3)", "sleep(0.5)")), 2, "The quickest took 0.5"),
        Wrong(
            "too_quick_at_times",
            changed(
                PARALLEL,
                (
                    "        time.sleep(0.3)\n",
                    "        self.n = getattr(self, 'n', 0) + 1\n        time.sleep(0.3 if self.n < 4 else 0.1)\n",
                ),
            ),
            2,
            "The quickest took 0.1",
        ),
    ],
    {"async": PARALLEL_ASYNC, "subclass": PARALLEL_SUBCLASS, "made_again": PARALLEL_MADE_AGAIN},
)
