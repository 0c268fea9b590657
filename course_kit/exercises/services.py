"""Chapter 4's exercises: what each asks of services, and how it is checked."""

from __future__ import annotations

from example_interfaces.srv import AddTwoInts
from std_srvs.srv import SetBool, Trigger

from course_kit.examining import trails
from course_kit.examining.exercise import exercise
from course_kit.examining.vocabulary import (
    a_turtle,
    answer,
    call,
    expect,
    expect_node,
    pause,
    pending_calls,
    read,
    require,
    wait,
    wait_for_servers,
)
from course_kit.examining.vocabulary_services import Client, a_server, add_two_ints, expect_service, no_answer
from course_kit.examining.vocabulary_topics import hear_the_turtle

SLOW_TICK = 0.25  # seconds; so slow that who asks just after a tick and does not wait for the next is always early
LATE = 1.5  # seconds that a wait of 0.5 s may take where the machine is busy


@exercise("services-1", "A lamp", points=2, level="warm-up", node_class="Lamp")
def lamp() -> None:
    """It is switched on and off; each response says whether that changed it, and what it is now."""
    answer()
    client = expect_service("/lamp", SetBool)
    begins_off = read("is_on") is False
    said = []
    for number, data in enumerate((True, True, False, False), start=1):
        said.append(client.ask(data=data).response)
        require(f"it answers request {number}", said[-1] is not None, no_answer("/lamp"))
    expect(
        "`success` tells whether the request changed the lamp",
        begins_off and [response.success for response in said] == [True, False, True, False],
        f"Asked for on, on, off, off it said {[response.success for response in said]}, and `self.is_on` began as "
        f"{'False' if begins_off else 'something else than False'}: compare request.data with self.is_on "
        f"before you set it.",
    )
    expect(
        "`message` and `self.is_on` tell the state afterwards",
        [response.message for response in said] == ["on", "on", "off", "off"] and read("is_on") is False,
        f"Asked for on, on, off, off its messages were {', '.join(repr(one.message) for one in said)}: "
        f"set self.is_on first, then the message.",
    )


@exercise("services-2", "A client that never hangs", points=2, level="medium", timeout=25, node_class="SafeClient")
def safe_client() -> None:
    """add() brings the sum, or None in time: without a server, and with one that does not answer."""
    answer()
    alone, alone_seconds = call("add", 1, 1, 0.5, timeout=4.0)
    server = a_server("/add_two_ints", AddTwoInts, add_two_ints)
    wait_for_servers(2.0)  # the request of a client that does not wait for it itself would be lost by chance
    brought, _ = call("add", 2, 3, 3.0, timeout=5.0)
    expect(
        "with a server it returns the sum",
        brought == 5 and len(server.requests) >= 1,
        f"add(2, 3, 3.0) returned {brought!r}, and the server got {len(server.requests)} requests: wait for the "
        "future, then return its result().sum.",
    )
    server.delay = 3.0
    slow, slow_seconds = call("add", 1, 1, 0.5, timeout=4.0)
    left = pending_calls()
    in_time = max(alone_seconds, slow_seconds) < LATE
    expect(
        "without a server or an answer it returns None in time, and leaves no future waiting",
        alone is None and slow is None and in_time and left == 0,
        _why_not_safe(alone, slow, alone_seconds, slow_seconds, left),
    )


def _why_not_safe(alone: object, slow: object, alone_seconds: float, slow_seconds: float, left: int) -> str:
    if alone is not None or slow is not None:
        return (
            f"It returned {alone!r} without a server and {slow!r} with one that did not answer, and not None: look at "
            f"what wait_for_service() returns, and catch the TimeoutError of wait_for()."
        )
    if max(alone_seconds, slow_seconds) >= LATE:
        return (
            f"With a timeout of 0.5 s it took {alone_seconds:.1f} s without a server and {slow_seconds:.1f} s with a "
            "slow one: `timeout` is for both waits together, so compute what is left of it."
        )
    return f"{left} futures still wait in the client: `self.client.remove_pending_request(future)` after a timeout."


@exercise("services-3", "Ask while you are asked", points=3, level="medium", timeout=20, node_class="AddThreeTimes")
def add_three_times() -> None:
    """It answers 3 · (a + b), asks /add_two_ints three times for that, and adds nothing itself."""
    server = a_server("/add_two_ints", AddTwoInts, add_two_ints)
    answer()
    client = expect_service("/add_three_times", AddTwoInts)
    first = client.ask(a=2, b=3).response
    asked = len(server.requests)
    require(
        "it answers",
        first is not None,
        f"{no_answer('/add_three_times')} A callback that waits for an answer is a deadlock: make it `async def`, "
        f"await call_async(), and give the client a callback group of its own.",
    )
    last = server.responses[-1].sum if server.responses else None
    second = client.ask(a=-4, b=5).response
    sums = [first.sum, None if second is None else second.sum]
    expect(
        "2 + 3 gives 15, and -4 + 5 gives 3 afterwards",
        sums == [15, 3],
        f"The answers were {sums[0]} and {'none' if sums[1] is None else sums[1]}: 3 · (a + b), for each request anew.",
    )
    expect(
        "it asks /add_two_ints three times",
        asked == 3,
        f"It asked {asked} times for one request: a + b, then that twice, then the two together.",
    )
    expect(
        "what it answers is the last thing it was told: it adds nothing itself",
        last == first.sum,
        f"The last answer of /add_two_ints was {last}, and it answered {first.sum}: let the server add the sums, too.",
    )


@exercise("services-4", "Three at a time", points=3, level="medium", timeout=20, node_class="ParallelServer", node="")
def parallel_server() -> None:
    """Each answer takes 0.3 s, and three requests at once are answered within 0.6 s."""
    answer(threads=True)
    expect_node("/add_two_ints_server")
    client = expect_service("/add_two_ints", AddTwoInts)
    single = client.ask(a=1, b=2)
    require("it answers", single.response is not None, no_answer("/add_two_ints"))
    requests = [{"a": number, "b": 10} for number in range(3)]
    answers, longest = [], 9.9
    for _ in range(3):  # a busy machine may be late once
        tried = client.ask_all(3.0, requests)
        if max(each.seconds for each in tried) < longest:
            answers, longest = tried, max(each.seconds for each in tried)
        if longest <= 0.6:
            break
    sums = [None if each.response is None else each.response.sum for each in answers]
    expect(
        "the sums are right",
        single.response.sum == 3 and sums == [10, 11, 12],
        f"1 + 2 gave {single.response.sum}, and 0 + 10, 1 + 10, 2 + 10 gave {sums}.",
    )
    shortest = min(single.seconds, *(each.seconds for each in answers))
    expect(
        "one answer takes 0.3 s",
        shortest >= 0.28,
        f"One took {shortest:.2f} s: the exercise keeps the time.sleep(0.3) of the slow server.",
    )
    expect(
        "three requests at once are answered within 0.6 s",
        longest <= 0.6,
        f"They took {longest:.2f} s, one after the other: the callbacks of one MutuallyExclusiveCallbackGroup wait for "
        f"each other, also with many threads. Give the service a ReentrantCallbackGroup.",
    )


@exercise("services-5", "Draw on demand", points=5, level="project", timeout=60, node_class="StarPainter")
def star_painter() -> None:
    """It draws a star, answers when it is there, and says so if there is no turtle."""
    answer()
    client = expect_service("/draw_star", Trigger)
    alone = client.ask(6.0)
    expect(
        "without a turtle it says so within 3 s",
        alone.response is not None and not alone.response.success and alone.seconds <= 3.5,
        f"{'No response came' if alone.response is None else f'It said success={alone.response.success}'} after "
        f"{alone.seconds:.1f} s: look at what wait_for_service(timeout_sec=…) returns, before the first call.",
    )
    if alone.response is None:  # what hangs may keep it from answering again
        answer()
        client = Client("/draw_star", Trigger)
    turtlesim = a_turtle(period=SLOW_TICK)
    poses = hear_the_turtle()
    wait(lambda: poses.received > 1, 3.0, "a tick")
    drawn = client.ask(40.0)
    require("with a turtle it answers", drawn.response is not None, no_answer("/draw_star", 40.0))
    at_the_end = trails.distance_to_end(turtlesim)
    expect(
        "it answers `5 lines` when it has arrived",
        drawn.response.success and drawn.response.message == "5 lines" and at_the_end < 0.3,
        f"It said success={drawn.response.success}, {drawn.response.message!r}, with the turtle {at_the_end:.1f} m "
        "from the end of the last line: wait for its pose, then respond.",
    )
    pause(2 * SLOW_TICK)  # the last tick of the pen
    seen = trails.star_seen(turtlesim)
    expect(
        "five lines of a star, in yellow",
        seen.complete == 5,
        f"{seen.complete} of the 5 lines are there in yellow: corners 4 m from (5.54, 5.54) at 90°, 234°, 18°, 162°, "
        f"306°, one straight above it. `turtlesim.picture()` shows what was drawn.",
    )
    expect(
        "they are 4 pixels wide",
        seen.width in (4, 5),
        f"They are about {seen.width} wide: `width=4` in the request of set_pen.",
    )
    expect(
        "nothing else is drawn",
        seen.elsewhere < 20 and seen.complete > 0,
        f"{seen.elsewhere} pixels are painted beside the star: lift the pen (`off=1`) for the way to the first corner. "
        "A teleport happens at the next tick, after its response: wait for the pose before the pen goes down."
        if seen.complete
        else "There is no star yet.",
    )
