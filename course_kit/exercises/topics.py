"""Chapter 3's exercises about messages: what each asks of topics, and how it is checked."""

from __future__ import annotations

import math
import time
from functools import partial
from itertools import pairwise
from operator import eq
from typing import Any

from rclpy.publisher import Publisher
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Int32
from turtlesim.msg import Pose

from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import (
    answer,
    chance,
    expect,
    nobody_else,
    pause,
    read,
    wait,
    wait_for_attribute,
)
from course_kit.examining.vocabulary_topics import (
    expect_compatible_subscription,
    expect_rate,
    expect_subscription,
    expect_topic,
    hear_no_longer,
    heard_once_more,
    is_published,
    listen,
    matches,
    publish_steadily,
    publisher,
    rate,
    values,
)
from course_kit.turtlesim.field import float32

TEN_TO_ZERO = list(range(10, -1, -1))
START_TIMEOUT = 1.5  # seconds from the first match to 10: the second of the text, and half a one for a busy machine
POSE_RATE = 62.5  # Hz, a turtle's
LATE = 0.1  # seconds from a pose to its relay, of half of them at most
FIELDS = ("x", "y", "theta", "linear_velocity", "angular_velocity")


@exercise("topics-1", "Count down", points=2, level="warm-up", timeout=25, node_class="Countdown")
def count_down() -> None:
    """It publishes 10, 9, … 0, five a second, from when somebody listens, and then no more; a new node does it anew.

    No time that a node could wait for in place of a listener suits both moments.
    """
    nobody_else("rt/countdown")
    heard, why = _one_count(chance().uniform(0.1, 0.4), again_after=len(TEN_TO_ZERO))
    counts = [heard]
    if not why:
        heard, why = _one_count(chance().uniform(2.5, 3.2), again_after=chance().randint(2, 8))
        counts.append(heard)
    expect("it counts 10, 9, … 0 from when somebody listens, and stops", not why, why)
    steadiest = min(counts, key=lambda heard: abs(rate(heard) - 5.0))
    expect_rate(steadiest, 5.0, within=0.15, steady=True)


def _one_count(moment: float, again_after: int) -> tuple[Heard, str]:
    """Listen to a new node after a moment, a second time after so many numbers; what came, and what is wrong in it."""
    answer(threads=None)
    expect_topic("/countdown", Int32)
    pause(moment)  # nobody listens yet, so nothing may be counted
    heard = listen("/countdown", Int32)
    matched = time.time_ns()
    if not wait(lambda: len(heard), timeout=4.0):
        return heard, _why_not_ten([])
    _wait_for(heard, again_after, quiet=1.2)
    with heard_once_more("/countdown", Int32) as numbered:
        _wait_for(heard, len(TEN_TO_ZERO), quiet=1.2)
        _wait_for(heard, len(TEN_TO_ZERO) + 3, quiet=0.7)
    hear_no_longer(heard)
    return heard, _what_is_wrong(heard, matched, numbered)


def _wait_for(heard: Heard, count: int, quiet: float) -> None:
    """Until so many have come, or for so many seconds none."""
    began = time.time_ns()
    wait(lambda: len(heard) >= count or time.time_ns() - max([began, *heard.times]) > quiet * 1e9, timeout=6.0)


def _what_is_wrong(heard: Heard, matched: int, numbered: list[tuple[int, Int32]]) -> str:
    counted = values(heard, "data")
    if counted != TEN_TO_ZERO:
        return _why_not_ten(counted)
    # Each number says how many were to be sent before it, and the middleware's how many were.
    if too_early := [sent for sent, number in numbered if sent + number.data > 11]:
        return (
            f"{too_early[0]} were sent when the check had heard fewer: nothing is published before somebody listens. "
            f"Publish only when `self.publisher.get_subscription_count()` is more than 0."
        )
    waited = (heard.times[0] - matched) * 1e-9
    if waited > START_TIMEOUT:
        return (
            f"It began {waited:.1f} s after the subscription had matched: wait for the match, that is until "
            f"`self.publisher.get_subscription_count()` is more than 0, and not for a time."
        )
    return ""


def _why_not_ten(counted: list[int]) -> str:
    if not counted:
        return (
            "Nothing came within 4 s. Does its timer wait for `self.publisher.get_subscription_count()`, and then "
            "publish? Begin with 10 in each new node: what is published before a subscription has matched is lost."
        )
    heard = f"Heard: {', '.join(map(str, counted[:14]))}."
    if counted == TEN_TO_ZERO[::-1]:
        return f"{heard} It counts up."
    if counted[0] < 10:
        return (
            f"{heard} The first numbers went to nobody: a message that is sent before a subscription has matched is "
            f"lost. Count only when `self.publisher.get_subscription_count()` is more than 0, and each new node anew."
        )
    if counted[: len(TEN_TO_ZERO)] == TEN_TO_ZERO:
        return (
            f"{heard} It goes on after 0, or counts again for who comes later: cancel the timer, or return before it "
            f"publishes."
        )
    return f"{heard} It should be 10, 9, … 0, each once, whoever begins to listen meanwhile."


@exercise("topics-2", "Why does nothing arrive?", points=2, level="medium", timeout=25, node_class="ScanCounter")
def sensor_qos() -> None:
    """It hears a laser that publishes with the sensors' QoS, and counts its scans."""
    nobody_else("rt/scan")
    laser = publisher("/scan", LaserScan, qos_profile_sensor_data)
    _a_counter()
    if not matches(laser):
        _a_counter()  # it may choose by the publishers that it knows, and by now it knows the laser
    expect_compatible_subscription("/scan", laser, points=1)
    sent, count = _two_bursts(laser)
    for _ in range(2):
        if not (isinstance(count, int | float) and 0.5 * sent <= count < sent):
            break
        _a_counter()  # best effort may lose a scan on a busy machine, but not each time
        matches(laser)
        sent, count = _two_bursts(laser)
    expect(
        "it counts the scans in `self.count`",
        count == sent,
        f"`self.count` is {count!r} after {sent} scans: begin with 0 and add 1 in the callback, for each message, "
        f"whatever is in it.",
    )


def _a_counter() -> None:
    answer(threads=None)
    expect_subscription("/scan", LaserScan)


def _two_bursts(laser: Publisher) -> tuple[int, Any]:
    """How many scans were sent and counted, in all or to where the count was wrong."""
    sent, count = 0, None
    for _ in range(2):
        scans = [_a_scan() for _ in range(chance().randint(8, 20))]
        sent += len(scans)
        publish_steadily(laser, scans, period=chance().uniform(0.02, 0.05))
        wait_for_attribute("count", partial(eq, sent), timeout=0.7)
        pause(chance().uniform(0.2, 0.4))
        count = read("count")  # none may be counted twice, or while none comes
        if count != sent:
            break
    return sent, count


def _a_scan() -> LaserScan:
    """Of any length, also an empty one, and one with nothing in reach."""
    length, is_near = chance().choice((0, 1, 3, 90, 360)), chance().random() < 0.8
    scan = LaserScan(ranges=[chance().uniform(0.1, 8.0) if is_near else math.inf for _ in range(length)])
    scan.header.stamp.sec, scan.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
    return scan


@exercise("topics-3", "A relay", points=3, level="medium", timeout=30, node_class="Relay")
def relay() -> None:
    """Of the poses on /turtle1/pose it publishes every tenth, unchanged, on /turtle1/pose_slow, whatever their rate."""
    nobody_else("rt/turtle1/pose", "rt/turtle1/pose_slow")
    turtle = publisher("/turtle1/pose", Pose)
    answer(threads=None)
    expect_subscription("/turtle1/pose", Pose)
    expect_compatible_subscription("/turtle1/pose", turtle)
    if not is_published("/turtle1/pose_slow"):  # it may make its publisher when the first poses come
        _send(turtle, POSE_RATE, 20)
    expect_topic("/turtle1/pose_slow", Pose)
    slow = listen("/turtle1/pose_slow", Pose)
    pause(0.3)
    sent, came = _two_rates(turtle, slow)
    for _ in range(2):
        if _is_every_tenth(sent, came) or not came or min(_steps(sent, came), default=0) < 10:
            break
        sent, came = _two_rates(turtle, slow)  # a short queue may lose poses on a busy machine: then 10 are too many
    expect(
        "what it publishes are poses that it got, unchanged",
        came and all(pose in [one for _, one in sent] for _, pose in came),
        _why_not_got(sent, came),
        needed=not came,
    )
    steps = _steps(sent, came)
    expect(
        "it is every tenth pose, whatever their rate",
        _is_every_tenth(sent, came),
        f"Of {len(sent)} poses {len(came)} came, most of them {sorted(steps)[len(steps) // 2] if steps else 0} after "
        f"the one before: count the calls of the callback, not the time, and publish when the count divides by 10.",
    )
    delay = _usual_delay(sent, came)
    expect(
        "a tenth of their rate comes out, each at once",
        abs(len(came) - len(sent) / 10) <= 2 + 0.1 * len(sent) / 10 and delay < LATE,
        f"Of {len(sent)} poses {len(came)} came, {delay:.2f} s after they were sent: publish in the callback. A tenth "
        f"of 62.5 Hz is 6.25 Hz: `%ros2 topic hz /turtle1/pose_slow` measures it.",
    )


Timed = list[tuple[int, Pose]]  # when poses were sent or came (nanoseconds), and the poses


def _two_rates(turtle: Publisher, slow: Heard) -> tuple[Timed, Timed]:
    """Some poses at the rate of a turtle and some at a lower one: what was sent, and what came of it."""
    before = len(slow)
    sent = _send(turtle, POSE_RATE, chance().randint(90, 130))
    sent += _send(turtle, chance().uniform(16, 28), chance().randint(45, 65))
    pause(0.4)
    return sent, slow.arrivals[before:]


def _send(turtle: Publisher, hz: float, count: int) -> Timed:
    """Send new poses, never two sooner after one another than their rate says: a queue of 1 is enough for them."""
    sent: Timed = []
    for pose in _some_poses(count):
        sent.append((time.time_ns(), pose))
        turtle.publish(pose)
        pause(1 / hz)
    return sent


def _some_poses(count: int) -> list[Pose]:
    """Like a turtle's, which may stand; no two the same."""

    def speed() -> float:
        return chance().choice((0.0, chance().uniform(-3.0, 3.0)))

    fields = [
        (chance().uniform(0, 11), chance().uniform(0, 11), chance().uniform(-math.pi, math.pi), speed(), speed())
        for _ in range(count)
    ]
    return [Pose(**dict(zip(FIELDS, map(float32, values), strict=True))) for values in fields]


def _numbers(sent: Timed, came: Timed) -> list[int | None]:
    """Which of the poses that were sent came: by one of x, y and theta, as something else may have been changed."""
    places = {field: {getattr(pose, field): n for n, (_, pose) in enumerate(sent)} for field in ("x", "y", "theta")}
    found = [[places[field].get(getattr(pose, field)) for field in places] for _, pose in came]
    return [next((number for number in numbers if number is not None), None) for numbers in found]


def _steps(sent: Timed, came: Timed) -> list[int]:
    """How many poses after the one before each is, as far as they are any."""
    return [after - before for before, after in pairwise(n for n in _numbers(sent, came) if n is not None)]


def _is_every_tenth(sent: Timed, came: Timed) -> bool:
    """One after nine, but for what a short queue has lost: then the next comes later, never earlier."""
    numbers, steps = [n for n in _numbers(sent, came) if n is not None], _steps(sent, came)
    if not steps or min(steps) < 10:
        return False
    return steps.count(10) > 0.7 * len(steps) and numbers[0] < 12 and numbers[-1] >= len(sent) - 12


def _usual_delay(sent: Timed, came: Timed) -> float:
    """Seconds from the sending of a pose to its coming, of half of them at most; 0 if none is known."""
    pairs = zip(_numbers(sent, came), came, strict=True)
    delays = sorted((when - sent[number][0]) * 1e-9 for number, (when, _) in pairs if number is not None)
    return delays[len(delays) // 2] if delays else 0.0


def _why_not_got(sent: Timed, came: Timed) -> str:
    if not came:
        return "Nothing came on `/turtle1/pose_slow`."
    hint = "Publish the message that the callback was given."
    for number, (_, pose) in zip(_numbers(sent, came), came, strict=True):
        changed = [] if number is None else [f for f in FIELDS if getattr(pose, f) != getattr(sent[number][1], f)]
        if changed:
            return f"{', '.join(changed)} of a pose came out otherwise than it went in. {hint}"
    return f"What came out are no poses that went in. {hint}"
