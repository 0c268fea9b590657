"""Nodes in the background: run, stop, wait_for, and every way in which a notebook could trip over rclpy."""

from __future__ import annotations

import functools
import gc
import subprocess
import sys
import time

import pytest
import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer, get_action_names_and_types
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions, get_current_signal_handlers_options
from rclpy.task import Future
from std_msgs.msg import String

from course_kit import logs, nodes, run, running, stop, wait_for
from course_kit.ros.spinning import BlockingWait, NodeAlreadyRuns, context, errors
from tests.waiting import wait_until


class Talker(Node):
    def __init__(self, name: str = "talker", **options) -> None:
        super().__init__(name, **options)
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.count = 0
        self.create_timer(0.01, self.tick)

    def tick(self) -> None:
        self.count += 1
        self.publisher.publish(String(data=str(self.count)))


class Listener(Node):
    def __init__(self) -> None:
        super().__init__("listener")
        self.heard: list[str] = []
        self.create_subscription(String, "chatter", self.hear, 10)

    def hear(self, message: String) -> None:
        self.heard.append(message.data)


class Adder(Node):
    def __init__(self) -> None:
        super().__init__("adder")
        self.create_service(AddTwoInts, "add", self.add)

    def add(self, request, response):
        response.sum = request.a + request.b
        return response


@pytest.fixture(autouse=True)
def nothing_left_running():
    yield
    stop()
    errors.clear()


def names() -> list[str]:
    return [node.get_fully_qualified_name() for node in nodes()]


def goes_on(talker: Talker) -> bool:
    """Return True if a talker's timer still fires."""
    before = talker.count
    return bool(wait_for(lambda: talker.count > before + 2))


def test_a_class_runs_and_is_heard():
    talker, listener = run(Talker), run(Listener)
    wait_for(lambda: len(listener.heard) >= 5)
    assert isinstance(talker, Talker) and type(talker).__name__ == "Talker"
    assert names() == ["/talker", "/listener"]


def test_running_a_cell_again_replaces_the_node():
    first = run(Talker)
    second = run(Talker)
    listener = run(Listener)
    assert second is not first
    wait_for(lambda: listener.count_publishers("/chatter") == 1)
    assert names() == ["/talker", "/listener"]
    assert goes_on(second)


def test_a_redefined_class_with_another_node_name_replaces_the_node_of_the_earlier_one():
    def define(name):
        class Lonely(Node):
            def __init__(self):
                super().__init__(name)

        return Lonely

    run(define("before"))
    run(define("after"))
    assert names() == ["/after"]


def test_another_class_with_the_same_node_name_replaces_the_node():
    class Impostor(Node):
        def __init__(self):
            super().__init__("talker")

    run(Talker)
    impostor = run(Impostor)
    assert nodes() == [impostor]


def test_the_replaced_node_and_the_new_one_both_reach_rosout():
    for text in ("first", "second"):
        talker = run(Talker)
        talker.get_logger().info(text)
        wait_for(lambda text=text: any(line.text == text for line in logs("/talker")), what=f"the line {text!r}")


def test_a_child_logger_of_the_new_node_goes_on_when_the_replaced_node_becomes_garbage():
    class Counter(Node):
        def __init__(self):
            super().__init__("counter")
            self.part = self.get_logger().get_child("part")
            self.itself = self  # as a callback or an action server does it: only the collector ends it

    gc.disable()
    try:
        run(Counter)
        counter = run(Counter)
    finally:
        gc.enable()
    gc.collect()
    counter.part.info("still here")
    wait_for(lambda: any(line.text == "still here" for line in logs(level="INFO")), what="the line of the child logger")


def test_the_same_class_runs_once_for_each_set_of_arguments():
    run(Talker, namespace="/robot1")
    run(Talker, namespace="/robot2")
    run(Talker, "other")
    run(Talker, namespace="/robot1")
    assert sorted(names()) == ["/other", "/robot1/talker", "/robot2/talker"]


def test_a_node_that_exists_can_be_handed_over():
    rclpy.init()
    talker = Talker()
    assert run(talker) is talker
    assert run(talker) is talker  # the cell run again
    assert goes_on(talker)
    assert names() == ["/talker"]


def test_twenty_nodes_run_at_once():
    talkers = [run(Talker, f"talker{number}") for number in range(20)]
    for talker in talkers:
        assert goes_on(talker)
    stop()
    assert nodes() == []


def test_init_may_come_twice_and_leaves_signals_to_the_cell():
    rclpy.init()
    rclpy.init()
    talker = run(Talker)
    rclpy.init()
    assert goes_on(talker)
    assert get_current_signal_handlers_options() == SignalHandlerOptions.NO


def test_init_with_another_domain_says_that_a_context_keeps_its_domain():
    run(Talker)
    other = rclpy.get_default_context().get_domain_id() + 1
    with pytest.raises(RuntimeError, match="cannot change its domain"):
        rclpy.init(domain_id=other)


def test_a_context_of_another_domain_can_be_made_beside():
    run(Talker)
    context = rclpy.context.Context()
    rclpy.init(context=context, domain_id=102)
    try:
        node = Node("elsewhere", context=context)
        assert node.count_publishers("/chatter") == 0
        node.destroy_node()
    finally:
        rclpy.shutdown(context=context)


def test_after_shutdown_run_starts_ros_again():
    run(Talker)
    rclpy.shutdown()
    wait_for(lambda: nodes() == [])
    talker = run(Talker)
    assert goes_on(talker)
    assert names() == ["/talker"]


def test_what_main_of_a_package_does_works_in_a_cell():
    def main():
        rclpy.init()
        node = Talker()
        future = Future()
        node.create_timer(0.05, lambda: future.set_result("done") if not future.done() else None)
        rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
        node.destroy_node()
        rclpy.shutdown()
        return future.result()

    assert main() == "done"
    assert main() == "done"


@pytest.mark.parametrize(
    "spin",
    [
        rclpy.spin,
        functools.partial(rclpy.spin_once, timeout_sec=0.1),
        lambda node: rclpy.spin_until_future_complete(node, Future(), timeout_sec=0.1),
        lambda node: SingleThreadedExecutor().add_node(node),
    ],
    ids=["spin", "spin_once", "spin_until_future_complete", "add_node"],
)
def test_spinning_a_node_that_runs_is_refused_and_it_goes_on(spin):
    talker = run(Talker)
    with pytest.raises(NodeAlreadyRuns, match=r"/talker already runs in the background.*wait_for"):
        spin(talker)
    assert goes_on(talker)


def test_an_exception_in_a_callback_is_kept_and_the_other_nodes_go_on():
    class Faulty(Node):
        def __init__(self):
            super().__init__("faulty")
            self.calls = 0
            self.create_timer(0.01, self.fail)

        def fail(self):
            self.calls += 1
            raise ValueError("no battery")

    talker, faulty = run(Talker), run(Faulty)
    wait_for(lambda: faulty.calls >= 3)
    assert goes_on(talker)
    assert goes_on_calling(faulty)
    (error,) = errors.errors("/faulty")
    assert error.count >= 3
    assert "a callback of /faulty raised ValueError: no battery" in str(error)
    assert 'raise ValueError("no battery")' in str(error)
    assert any("no battery" in line.text for line in logs("/faulty", level="ERROR"))


def goes_on_calling(node) -> bool:
    before = node.calls
    return bool(wait_for(lambda: node.calls > before))


class Informed(Node):
    """Hears itself, with what the middleware says of each message."""

    def __init__(self) -> None:
        super().__init__("informed")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.infos: list[dict] = []
        self.create_timer(0.01, lambda: self.publisher.publish(String(data="x")))

    def hear(self, _: String, info: dict) -> None:
        self.infos.append(info)


@pytest.mark.parametrize("executor", [None, SingleThreadedExecutor, MultiThreadedExecutor])
def test_a_callback_with_a_second_argument_gets_the_message_info(executor):
    class FromTheStart(Informed):
        def __init__(self) -> None:
            super().__init__()
            self.create_subscription(String, "chatter", self.hear, 10)  # type: ignore[arg-type]

    context.start()
    node = run(FromTheStart, executor=executor and executor())
    wait_for(lambda: len(node.infos) > 3)
    assert node.infos[0]["received_timestamp"] > node.infos[0]["source_timestamp"] > 0
    assert errors.errors() == []


def test_so_does_one_that_comes_when_the_node_runs_already():
    node = run(Informed)
    node.create_subscription(String, "chatter", node.hear, 10)
    wait_for(lambda: len(node.infos) > 3)
    assert errors.errors() == []
    stop(node)
    assert nodes() == []


def test_a_callback_that_blocks_stalls_its_own_node_only():
    class Blocked(Node):
        def __init__(self):
            super().__init__("blocked")
            self.entered = False
            self.create_timer(0.01, self.block)

        def block(self):
            self.entered = True
            while True:
                time.sleep(0.01)

    talker, blocked = run(Talker), run(Blocked)
    wait_for(lambda: blocked.entered)
    assert goes_on(talker)
    before = time.monotonic()
    stop(blocked)
    assert time.monotonic() - before < 3.0
    assert names() == ["/talker"]
    wait_until(lambda: "blocked" not in talker.get_node_names())


def test_client_call_works_in_a_cell_and_wait_for_gives_the_response():
    run(Adder)
    client = run(Listener).create_client(AddTwoInts, "add")
    assert client.wait_for_service(timeout_sec=5.0)
    assert client.call(AddTwoInts.Request(a=2, b=3), timeout_sec=5.0) == AddTwoInts.Response(sum=5)
    assert wait_for(client.call_async(AddTwoInts.Request(a=4, b=5))).sum == 9


class Caller(Node):
    """Calls /add from a timer in the way that the test gives."""

    def __init__(self, call) -> None:
        super().__init__("caller")
        group = MutuallyExclusiveCallbackGroup()
        self.client = self.create_client(AddTwoInts, "add", callback_group=group)
        self.sums: list[int] = []
        self.timer = self.create_timer(0.01, functools.partial(call, self))


def call_and_wait(node: Caller) -> None:
    node.timer.cancel()
    response = node.client.call(AddTwoInts.Request(a=1, b=2))
    assert response is not None
    node.sums.append(response.sum)


def call_and_wait_for(node: Caller) -> None:
    node.timer.cancel()
    node.sums.append(wait_for(node.client.call_async(AddTwoInts.Request(a=1, b=2))).sum)


async def call_and_await(node: Caller) -> None:
    node.timer.cancel()
    response = await node.client.call_async(AddTwoInts.Request(a=1, b=2))
    node.sums.append(response.sum)


@pytest.mark.parametrize("call", [call_and_wait, call_and_wait_for])
def test_a_blocking_wait_in_a_callback_is_an_error_at_once(call):
    run(Adder)
    run(Caller, call)
    wait_for(lambda: errors.errors("/caller"), timeout=2.0)
    (error,) = errors.errors("/caller")
    assert isinstance(error.exception, BlockingWait)
    assert "busy running this callback" in str(error) and "call_async" in str(error)


def test_awaiting_a_service_in_a_callback_works():
    run(Adder)
    caller = run(Caller, call_and_await)
    wait_for(lambda: caller.sums == [3])


def test_with_a_multi_threaded_executor_a_callback_may_block():
    run(Adder)
    caller = run(Caller, call_and_wait, executor=MultiThreadedExecutor(2))
    wait_for(lambda: caller.sums == [3])


def test_wait_for_says_which_service_did_not_answer():
    client = run(Listener).create_client(AddTwoInts, "ad")
    with pytest.raises(TimeoutError, match=r"service ad did not come within 0\.2 s.*example_interfaces/srv/AddTwoInts"):
        wait_for(client.call_async(AddTwoInts.Request()), timeout=0.2)


def test_wait_for_says_which_condition_did_not_come_true():
    with pytest.raises(TimeoutError, match=r"the pose did not come true within 0\.1 s.*logs\(\)"):
        wait_for(lambda: False, timeout=0.1, what="the pose")
    with pytest.raises(TypeError, match="function without arguments"):
        wait_for(3)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (String, r"String is not one. Write: class String\(Node\)"),
        (3, "takes a Node class or a node, not int"),
    ],
)
def test_run_says_what_it_takes(wrong, message):
    with pytest.raises(TypeError, match=message):
        run(wrong)


def test_a_constructor_that_fails_leaves_no_node_in_the_graph():
    class HalfMade(Node):
        def __init__(self):
            super().__init__("half_made")
            self.create_publisher(String, "not a topic", 10)

    talker = run(Talker)
    with pytest.raises(Exception, match="topic name"):
        run(HalfMade)
    wait_for(lambda: "half_made" not in talker.get_node_names())
    assert names() == ["/talker"]


def test_stop_takes_a_node_a_name_or_a_class_and_may_come_twice():
    talker = run(Talker)
    stop(talker)
    stop(talker)
    run(Talker)
    stop("talker")
    run(Talker)
    stop(Talker)
    assert nodes() == []
    run(Talker)
    with pytest.raises(ValueError, match="Did you mean /talker"):
        stop("/tolker")


@pytest.mark.parametrize("destroys_it", [True, False], ids=["destroys its server", "leaves it"])
def test_a_stopped_action_server_leaves_the_graph(destroys_it):
    class Counter(Node):
        def __init__(self) -> None:
            super().__init__("counter")
            self.server = ActionServer(self, Fibonacci, "count", lambda goal: Fibonacci.Result())

        def destroy_node(self) -> None:
            if destroys_it:
                self.server.destroy()
            super().destroy_node()

    talker = run(Talker)
    run(Counter)
    wait_for(lambda: "counter" in talker.get_node_names())
    stop(Counter)
    wait_for(lambda: "counter" not in talker.get_node_names())
    assert "/count" not in dict(get_action_names_and_types(talker))


def test_a_stopped_lifecycle_node_leaves_the_graph():
    talker, kept = run(Talker), run(LifecycleNode, "managed")
    wait_for(lambda: "managed" in talker.get_node_names())
    stop(kept)
    wait_for(lambda: "managed" not in talker.get_node_names())


def test_running_stops_its_nodes_at_the_end_of_the_block():
    with running(Talker, Listener) as (talker, listener):
        wait_for(lambda: listener.heard)
        assert names() == ["/talker", "/listener"]
    assert nodes() == []
    with pytest.raises(ZeroDivisionError), running(Talker) as talker:
        assert goes_on(talker)
        _ = 1 / 0
    assert nodes() == []


SCRIPT = """
from rclpy.node import Node
from std_msgs.msg import String
from course_kit import run, wait_for, logs
class Talker(Node):
    def __init__(self, name):
        super().__init__(name)
        self.count = 0
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.001, self.tick)
    def tick(self):
        self.count += 1
        self.publisher.publish(String(data="x"))
        self.get_logger().info("tick")
talkers = [run(Talker, f"talker{number}") for number in range(3)]
wait_for(lambda: all(talker.count > 10 for talker in talkers))
print("done")
"""


@pytest.mark.parametrize("attempt", range(5))
def test_python_ends_without_a_hang_or_a_crash_while_nodes_run(attempt):
    finished = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, timeout=60)
    assert (finished.returncode, finished.stdout, finished.stderr) == (0, "done\n", "")
