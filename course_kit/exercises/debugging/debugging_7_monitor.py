"""The check of debugging-7: a node that monitors the rates of topics."""

from __future__ import annotations

import re
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from turtlesim.msg import Pose

from course_kit.exercises.checker.assertions import answer, chance, expect, pause, time_left, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.topic_assertions import (
    expect_compatible_subscription,
    expect_rate,
    expect_subscription,
    expect_topic,
    listen,
    publisher,
)
from course_kit.ros.observing.received_messages import ReceivedMessages

SCANS, POSES = "/scan", "/turtle1/pose"
LEVELS = {b"\x00": "OK", b"\x01": "WARN", b"\x02": "ERROR", b"\x03": "STALE"}
WANTED = {SCANS: 10.0, POSES: 62.5}  # Hz
LEVEL_OF = {"more": "OK", "full": "OK", "most": "WARN", "third": "WARN", "none": "STALE"}
# Parts of the rates. Scans are few, so what a second has of them is a tenth more or less.
PARTS = {
    SCANS: {"more": (1.45, 1.6), "full": (0.83, 0.86), "most": (0.6, 0.65), "third": (0.3, 0.4), "none": (0.0, 0.0)},
    POSES: {"more": (1.3, 1.4), "full": (0.86, 0.88), "most": (0.7, 0.73), "third": (0.3, 0.4), "none": (0.0, 0.0)},
}
STEADY = 1.9  # seconds after a change in which a report may be of both rates; a change follows a report
REPORTS = 3  # in time, one of which must be right: messages and timers may be a little early or late
LATE = 0.045  # seconds; with it a second has nine of 8.6 scans at most
SENT_WITHIN = 0.02  # parts of a rate, and one message
RATE_WITHIN = 0.2  # parts of a rate, and one message
PHASE = STEADY + REPORTS + 1  # seconds at most, on a machine that is not late
END = 3.0  # seconds that are left behind the last phase
FIRST_REPORT = 3.3  # seconds
TEXT_POINTS = "count what comes, look once a second, begin to count anew"


@check_of("debugging-7")
def monitor() -> None:
    """It reports on two topics what comes of what should come."""
    publishers = {SCANS: publisher(SCANS, LaserScan, qos_profile_sensor_data), POSES: publisher(POSES, Pose)}
    answer(threads=None)
    expect_subscription(SCANS, LaserScan)
    expect_subscription(POSES, Pose)
    expect_topic("/diagnostics", DiagnosticArray)
    for topic, each in publishers.items():
        expect_compatible_subscription(topic, each)
    heard = listen("/diagnostics", DiagnosticArray)
    wait(lambda: len(heard), FIRST_REPORT, "the first report")
    pause(0.1)
    silence = Phase(dict.fromkeys(WANTED, "none"), dict.fromkeys(WANTED, 0.0))
    silence.look_at(heard.arrivals)
    phases = _phases()
    for number, phase in enumerate(phases, 1):
        _run(phase, publishers, heard, reserve=END + PHASE * (len(phases) - number))
    phases.insert(0, silence)
    named = [[status.name for status in report.status] for report in heard.messages]
    lacking = [names for names in named if any(names.count(topic) != 1 for topic in WANTED)]
    expect(
        "each report has a status for both topics",
        named and not lacking,
        f"A report names {', '.join((lacking or [[]])[-1]) or 'nothing'}: one DiagnosticStatus for each topic, with "
        f"the topic as its name, in one array.",
    )
    expect_rate(heard, 1.0, within=0.15)
    wrong = [text for phase in phases for text in phase.wrong_levels("OK")]
    expect(
        "a topic is OK at 80 % of its rate and above",
        not wrong,
        f"{_first(wrong)} What comes is at least 80 %: {TEXT_POINTS}.",
    )
    wrong = [text for level in ("WARN", "STALE") for phase in phases for text in phase.wrong_levels(level)]
    expect(
        "it is WARN below that, and STALE when nothing comes",
        not wrong,
        f"{_first(wrong)} Below 80 % of what should come is WARN, nothing is STALE, each topic by itself: "
        f"{TEXT_POINTS}.",
    )
    wrong = [text for phase in phases for text in phase.wrong_rates()]
    expect(
        "`rate` has the rates that came",
        not wrong,
        f"{_first(wrong)} It is a KeyValue(key='rate', value=…), a number as text: the messages of the last second.",
    )


@dataclass
class TopicStatus:
    """Holds one topic's status of one report, and what was true then."""

    level: str
    text: str | None  # of `rate`
    sent: int  # messages in the second before it: a busy machine does not get to all
    after: float | None  # seconds since the topic's status before it


@dataclass
class Phase:
    """A time in which the rates are steady, and what was reported of them then."""

    kinds: Mapping[str, str]
    rates: Mapping[str, float]  # Hz
    sent: dict[str, list[int]] = field(default_factory=lambda: {topic: [] for topic in WANTED})  # when, ns
    said: dict[str, list[TopicStatus]] = field(default_factory=lambda: {topic: [] for topic in WANTED})

    def look_at(self, reports: list[tuple[int, Any]], since: int = 0) -> None:
        """Note what the reports since a time say, of all that came: each with when it came, in ns as the time is."""
        self.said = {topic: [] for topic in WANTED}
        before: dict[str, int] = {}
        for when, report in reports:
            for status in report.status:
                if (topic := status.name) not in WANTED:
                    continue
                if when >= since:
                    level = LEVELS.get(bytes(status.level), "?")
                    text = next((pair.value for pair in status.values if pair.key == "rate"), None)
                    sent = sum(when - 1e9 < each <= when for each in self.sent[topic])
                    after = (when - before[topic]) / 1e9 if topic in before else None
                    self.said[topic].append(TopicStatus(level, text, sent, after))
                before[topic] = when

    def punctual(self, topic: str) -> list[TopicStatus]:
        """Statuses of a topic behind a second in which neither the messages went out late nor the report."""
        return [
            each
            for each in self.said[topic]
            if each.after is not None and abs(each.after - 1.0) <= LATE and self._fits(topic, each.sent)
        ]

    def in_time(self, topic: str) -> list[TopicStatus]:
        """Of the punctual statuses those that tell a rate as it was: no message reached the monitor late.

        In a longer second, or in one into which late messages fall, a monitor that is wrong may count enough.
        """
        return [each for each in self.punctual(topic) if self._fits(topic, _number(each.text) or 0.0)]

    def judged(self, topic: str) -> list[TopicStatus]:
        """Statuses of a topic that count: all, where none was in time."""
        return self.in_time(topic) or self.punctual(topic) or self.said[topic]

    def _fits(self, topic: str, count: float) -> bool:
        """Tell if so many messages a second are those of the topic's rate."""
        rate = self.rates[topic]
        return abs(count - rate) <= 1.0 + SENT_WITHIN * rate

    @property
    def is_late(self) -> bool:
        """True if a topic has statuses, but no punctual one."""
        return any(self.said[topic] and not self.punctual(topic) for topic in WANTED)

    @property
    def is_right(self) -> bool:
        """True if nothing is wrong with it."""
        return not (self.wrong_rates() or any(self.wrong_levels(level) for level in LEVELS.values()))

    def wrong_levels(self, wanted: str) -> list[str]:
        """Of the topics that should have this level, those that never had it, in words."""
        return [
            f"While {self._came(topic)} it said {(levels or ['nothing'])[-1]}."
            for topic in WANTED
            if LEVEL_OF[self.kinds[topic]] == wanted
            and wanted not in (levels := [each.level for each in self.judged(topic)])
        ]

    def wrong_rates(self) -> list[str]:
        """The topics whose rate was never told, in words."""
        return [
            f"While {self._came(topic)}, `rate` was {_quoted([each.text for each in self.said[topic]])}."
            for topic, rate in self.rates.items()
            if not any(
                each.text is not None and (_is_about(each.text, rate) or _is_about(each.text, each.sent))
                for each in self.said[topic]
            )
        ]

    def _came(self, topic: str) -> str:
        return f"{self.rates[topic]:.1f} of {WANTED[topic]:g} messages a second came on {topic}"


def _phases() -> list[Phase]:
    """Five pairs of rates: each topic has each kind once, never both the same level, at first never none."""
    while True:
        scans, poses = (chance().sample(sorted(LEVEL_OF), len(LEVEL_OF)) for _ in WANTED)
        pairs = list(zip(scans, poses, strict=True))
        if "none" not in pairs[0] and all(LEVEL_OF[a] != LEVEL_OF[b] for a, b in pairs):
            break
    phases = [{SCANS: a, POSES: b} for a, b in pairs]
    return [
        Phase(kinds, {topic: WANTED[topic] * chance().uniform(*PARTS[topic][kinds[topic]]) for topic in WANTED})
        for kinds in phases
    ]


def _run(phase: Phase, publishers: Mapping[str, Any], heard: ReceivedMessages, reserve: float) -> None:
    """Publish at the rates of a phase until a report is right, or some are not.

    On a busy machine none may be punctual: then go on while more than `reserve` seconds are left.
    """
    began, since = time.monotonic(), time.time_ns() + int(STEADY * 1e9)
    due = {topic: began + chance().random() / rate for topic, rate in phase.rates.items() if rate}
    messages = {SCANS: LaserScan(ranges=[1.0]), POSES: Pose()}
    looked_at = 0
    while time.monotonic() < began + PHASE or (phase.is_late and time_left() > reserve):
        now = time.monotonic()
        for topic in [topic for topic, when in due.items() if when <= now]:
            publishers[topic].publish(messages[topic])
            phase.sent[topic].append(time.time_ns())
            due[topic] += 1 / phase.rates[topic]
        if len(heard) > looked_at:
            arrivals = heard.arrivals
            phase.look_at(arrivals, since)
            looked_at = len(arrivals)
            reports = min(len(phase.in_time(topic)) for topic in WANTED)
            if reports >= REPORTS or (reports and phase.is_right):
                break
        pause(max(0.0, min([*due.values(), now + 0.05]) - time.monotonic()))


def _is_about(text: str, rate: float) -> bool:
    """Return True if a text has a number that is this rate, with a unit or without; for 0 also none, as of nothing."""
    number = _number(text)
    if number is None:
        return rate == 0.0
    return abs(number - rate) <= (1.0 + RATE_WITHIN * rate if rate else 0.5)


def _number(text: str | None) -> float | None:
    """The first number in a text."""
    found = re.search(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", (text or "").lower())
    return None if found is None else float(found[0])


def _quoted(texts: list[str | None]) -> str:
    return "missing" if not texts or texts[-1] is None else repr(texts[-1])


def _first(wrong: list[str]) -> str:
    return wrong[0] if wrong else ""
