"""Answers to services-3: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

ADD_THREE_TIMES = worked("services-3")

# The service may be asked by several at once, and so does each in its turn.
THREE_TIMES_REENTRANT = """
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup

class AddThreeTimes(Node):
    def __init__(self):
        Node.__init__(self, "add_three_times")
        own = MutuallyExclusiveCallbackGroup()
        self.client = self.create_client(AddTwoInts, "/add_two_ints", callback_group=own)
        self.create_service(AddTwoInts, "/add_three_times", self.serve, callback_group=ReentrantCallbackGroup())

    async def serve(self, request, response):
        sums = [0, 0]
        for pair in (lambda: (request.a, request.b), lambda: (sums[2],) * 2, lambda: (sums[2], sums[3])):
            answered = await self.client.call_async(AddTwoInts.Request(**dict(zip("ab", pair()))))
            sums.append(answered.sum)
        response.sum = sums[-1]
        return response
"""

THREE_TIMES_BY_A_HELPER = """
import threading
from rclpy.executors import SingleThreadedExecutor

class AddThreeTimes(Node):
    def __init__(self):
        super().__init__("add_three_times")
        self.asker = Node("add_three_times_asker")
        self.client = self.asker.create_client(AddTwoInts, "add_two_ints")
        self.create_service(AddTwoInts, "add_three_times", self.serve)
        self.spinner = SingleThreadedExecutor()
        self.spinner.add_node(self.asker)
        self.thread = threading.Thread(target=self.spinner.spin, daemon=True)
        self.thread.start()

    def ask(self, a, b):
        return self.client.call(AddTwoInts.Request(a=a, b=b)).sum

    def serve(self, request, response):
        once = self.ask(request.b, request.a)
        response.sum = self.ask(once, self.ask(once, once))
        return response

    def destroy_node(self):
        self.spinner.shutdown()
        self.thread.join(1.0)
        super().destroy_node()
"""

THREE_TIMES_CHAINED = """
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.lifecycle import LifecycleNode
from rclpy.task import Future

class AddThreeTimes(LifecycleNode):
    def __init__(self):
        super().__init__("add_three_times")
        group = ReentrantCallbackGroup()
        self.client = self.create_client(AddTwoInts, "add_two_ints", callback_group=group)
        self.create_service(AddTwoInts, "add_three_times", self.serve, callback_group=group)

    def then(self, a, b, go_on):
        self.client.call_async(AddTwoInts.Request(a=a, b=b)).add_done_callback(lambda f: go_on(f.result().sum))

    async def serve(self, request, response):
        done = Future()

        def doubled(once):
            self.then(once, once, lambda twice: self.then(twice, once, done.set_result))

        self.then(request.a, request.b, doubled)
        response.sum = await done
        return response
"""

ANSWERS = Answers(
    "services-3",
    3,
    ADD_THREE_TIMES,
    [
        Wrong(
            "deadlock",
            changed(ADD_THREE_TIMES, ("await self.client.call_async(", "self.client.call(")),
            0,
            "client.call() inside a callback",
        ),
        Wrong(
            "same_group",
            changed(ADD_THREE_TIMES, (", callback_group=ReentrantCallbackGroup()", "")),
            0,
            "a callback group of its own",
        ),
        Wrong(
            "adds_itself",
            changed(ADD_THREE_TIMES, ("await self.ask(twice, once)", "twice + once")),
            1,
            "It asked 2 times",
        ),
        Wrong(
            "sums_three",
            changed(
                ADD_THREE_TIMES,
                ("await self.ask(once, once)", "once + await self.ask(request.a, request.b)"),
                ("await self.ask(twice, once)", "twice + await self.ask(request.a, request.b)"),
            ),
            2,
            "let the server add the sums",
        ),
        Wrong(
            "future_as_sum",
            changed(
                ADD_THREE_TIMES,
                (
                    "(await self.client.call_async(AddTwoInts.Request(a=a, b=b))).sum",
                    "self.client.call_async(AddTwoInts.Request(a=a, b=b)).sum",
                ),
            ),
            0,
            "AttributeError",
        ),
        Wrong(
            "shared_by_two_clients",
            changed(
                THREE_TIMES_REENTRANT,
                ("sums = [0, 0]", "self.sums = [0, 0]"),
                ("(sums[2],)", "(self.sums[-1],)"),
                ("(sums[2], sums[3])", "(self.sums[-2], self.sums[-1])"),
                (" sums.append", " self.sums.append"),
                ("= sums[-1]", "= self.sums[-1]"),
            ),
            2,
            "stays in local variables",
        ),
        Wrong(
            "never_emptied",
            changed(
                ADD_THREE_TIMES,
                (
                    "        once = await self.ask(request.a, request.b)",
                    "        if not hasattr(self, 'once'):\n"
                    "            self.once = await self.ask(request.a, request.b)\n"
                    "        once = self.once",
                ),
            ),
            0,
            "for each request anew",
        ),
        Wrong(
            "asks_for_show",
            changed(
                ADD_THREE_TIMES,
                ("return response", "response.sum = 3 * (request.a + request.b)\n        return response"),
            ),
            2,
            "let the server add the sums",
        ),
        Wrong(
            "adds_before_it_asks",
            changed(ADD_THREE_TIMES, ("self.ask(twice, once)", "self.ask(3 * (request.a + request.b), 0)")),
            2,
            "let the server add the sums",
        ),
        Wrong(
            "four_times",
            changed(
                ADD_THREE_TIMES,
                ("        return response", "        await self.ask(once, twice)\n        return response"),
            ),
            2,
            "It asked 4 times",
        ),
        Wrong(
            "floats",
            changed(
                ADD_THREE_TIMES,
                ("AddTwoInts.Request(a=a, b=b)", "AddTwoInts.Request(a=int(float(a)), b=int(float(b)))"),
            ),
            2,
            "in place of",
        ),
        Wrong(
            "zero_is_nothing",
            changed(
                ADD_THREE_TIMES,
                ("        twice =", "        if not once:\n            return response\n        twice ="),
            ),
            2,
            "It asked",
        ),
        Wrong(
            "keeps_answers",
            changed(
                ADD_THREE_TIMES,
                ("serve)\n", "serve)\n        self.kept = {}\n"),
                (
                    "        once =",
                    "        key = request.a, request.b\n        if key in self.kept:\n"
                    "            return self.kept[key]\n        once =",
                ),
                ("        return response\n", "        self.kept[key] = response\n        return response\n"),
            ),
            2,
            "for each request anew",
        ),
        Wrong(
            "only_with_threads",
            changed(
                ADD_THREE_TIMES,
                ("async def", "def"),
                ("await self.ask", "self.ask"),
                (
                    "(await self.client.call_async(AddTwoInts.Request(a=a, b=b)))",
                    "self.client.call(AddTwoInts.Request(a=a, b=b), timeout_sec=1.0)",
                ),
            ),
            0,
            "has no attribute 'sum'",
        ),
    ],
    {"reentrant": THREE_TIMES_REENTRANT, "helper": THREE_TIMES_BY_A_HELPER, "chained": THREE_TIMES_CHAINED},
)
