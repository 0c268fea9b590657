"""The check of debugging-3: a node that reports when a topic falls silent."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from itertools import pairwise
from statistics import median

from rclpy.publisher import Publisher
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool

from course_kit.exercises.checker.assertions import answer, chance, expect, pause
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.topic_assertions import (
    expect_compatible_subscription,
    expect_subscription,
    expect_topic,
    listen,
    publisher,
    values,
)
from course_kit.ros.observing.received_messages import ReceivedMessages

SCANS = "/scan"
FRESH = 0.5  # seconds
LEEWAY = 0.1  # seconds that a scan and a message may take on their way, in all
RATE = 5.0  # Hz
RATE_WITHIN = 0.2  # parts of it, and one message more or less
MOST_BEAMS = 4
WHOLE_WITHIN = 0.12  # the same over the whole of a turn, and parts of the usual time from one message to the next
EARLY, LATE = (0.02, 0.06), (0.14, 0.16)  # seconds from a message to the last scan: true at 0.36 s, false at 0.65 s


@check_of("debugging-3")
def watchdog() -> None:
    """It says five times a second whether a scan has come in the last half second."""
    laser = publisher(SCANS, LaserScan, qos_profile_sensor_data)
    answer(threads=None)
    expect_subscription(SCANS, LaserScan)
    expect_topic("/scan_alive", Bool)
    alive = listen("/scan_alive", Bool)
    pause(chance().uniform(0.8, 1.3))
    said = values(alive, "data")
    expect(
        "without a scan it says false",
        said and not any(said),
        f"It said {said[-5:] or 'nothing'}. Nothing had come yet: begin with no time at all, or one long ago.",
    )
    expect_compatible_subscription(SCANS, laser)
    sent = [0]  # times of the scans, as of time.time_ns()
    turn = _watch_scans(alive, laser, sent)
    if turn.wrong or turn.off_rate:  # a busy machine may be late once
        turn = _watch_scans(alive, laser, sent)
    expect(
        "it says true while a scan has come in the last 0.5 s, else false",
        not turn.wrong,
        f"{'; '.join(turn.wrong[:1])}: keep the time of each scan, and compare it with the present time in the timer's "
        f"callback, not in that of the scan.",
    )
    expect(
        "`/scan_alive` has 5 messages a second, however many scans come",
        not turn.off_rate,
        f"{'; '.join(turn.off_rate[:1])}: one timer with a period of 0.2 s publishes, and nothing else. "
        f"`%ros2 topic hz /scan_alive` measures it.",
    )


@dataclass
class _Turn:
    """What was wrong while scans came and did not come."""

    wrong: list[str] = field(default_factory=list)
    off_rate: list[str] = field(default_factory=list)


def _watch_scans(alive: ReceivedMessages, laser: Publisher, sent: list[int]) -> _Turn:
    """Send many scans, few, and one, each followed by a time without any; their times are added to `sent`."""
    turn = _Turn()
    fast = chance().uniform(10.0, 20.0)
    many, beams = round(fast * chance().uniform(0.8, 1.2)), chance().sample((0, 1), 2)  # a scan without any is one too
    bursts = [(fast, many, MOST_BEAMS), (2.5, chance().randint(3, 4), beams[0]), (2.5, 1, beams[1])]
    chance().shuffle(bursts)
    phases = [EARLY, EARLY, LATE]
    chance().shuffle(phases)
    turn_began, all_since = time.monotonic(), time.time_ns()
    for (rate, count, last_beams), phase in zip(bursts, phases, strict=True):
        began = due = time.monotonic()
        since = time.time_ns()
        for number in range(count):
            is_last = number == count - 1
            if is_last:
                _pause_until_after_a_message(alive, chance().uniform(*phase))
            sent.append(time.time_ns())
            laser.publish(_a_scan(last_beams if is_last else chance().randint(0, MOST_BEAMS)))
            due += 1 / rate
            pause(max(0.0, due - time.monotonic()))
        pause(chance().uniform(0.85, 1.0))
        seconds, came = time.monotonic() - began, [arrival for arrival in alive.arrivals if arrival[0] >= since]
        if abs(len(came) - RATE * seconds) > 1 + RATE_WITHIN * RATE * seconds:
            scans = f"{count} scans came, {rate:.1f} a second" if count > 1 else "one scan came"
            turn.off_rate.append(f"In {seconds:.1f} s in which {scans}, it published {len(came)} times")
        turn.wrong += [text for when, message in came if (text := _why_wrong(message.data, when, sent))]
    seconds, times = time.monotonic() - turn_began, [when for when in alive.times if when >= all_since]
    counted = f"In {seconds:.1f} s it published {len(times)} times"
    if abs(len(times) - RATE * seconds) > 1 + WHOLE_WITHIN * RATE * seconds:
        turn.off_rate.append(counted)
    # A busy machine leaves ticks out: then a rate that is too high has the right count.
    elif abs((period := median(after - before for before, after in pairwise(times)) * 1e-9) * RATE - 1) > WHOLE_WITHIN:
        turn.off_rate.append(f"{counted}, mostly {period:.2f} s apart")
    return turn


def _pause_until_after_a_message(alive: ReceivedMessages, seconds: float) -> None:
    """Wait until it is so long after a message, as far as the last one tells when they come."""
    last = alive.times[-1] * 1e-9 if len(alive) else 0.0
    pause((last + seconds - time.time()) % (1 / RATE))


def _why_wrong(said: bool, when: int, sent: list[int]) -> str:
    """Nothing if what was said at a time is true of the scans that were sent until then; else how it is not."""
    ages = [(when - one) * 1e-9 for one in sent if one <= when]
    if not said and any(LEEWAY <= age <= FRESH - LEEWAY for age in ages):
        return f"It said false {min(age for age in ages if age >= LEEWAY):.2f} s after a scan"
    if said and min(ages) > FRESH + LEEWAY:
        return f"It said true {min(ages):.2f} s after the last scan"
    return ""


def _a_scan(beams: int) -> LaserScan:
    """A scan of now."""
    scan = LaserScan(angle_min=-math.pi, angle_increment=math.pi / 2, range_max=16.0)
    scan.header.frame_id, scan.header.stamp = "turtle1", current().test_domain.node.get_clock().now().to_msg()
    scan.ranges = [chance().uniform(0.5, 10.0) for _ in range(beams)]
    return scan
