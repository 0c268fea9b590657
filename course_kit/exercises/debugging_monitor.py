"""Chapter 6's exercise on a monitor: what it asks, and how it is checked."""

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

from course_kit.examining.exercise import exercise
from course_kit.examining.heard import Heard
from course_kit.examining.vocabulary import answer, chance, expect, pause, wait
from course_kit.examining.vocabulary_topics import (
    expect_compatible_subscription,
    expect_rate,
    expect_subscription,
    expect_topic,
    listen,
    publisher,
)

SCANS, POSES = "/scan", "/turtle1/pose"
LEVELS = {b"\x00": "OK", b"\x01": "WARN", b"\x02": "ERROR", b"\x03": "STALE"}
WANTED = {SCANS: 10.0, POSES: 62.5}  # Hz
LEVEL_OF = {"more": "OK", "full": "OK", "most": "WARN", "third": "WARN", "none": "STALE"}
# Parts of the rates. Scans are few, so what a second has of them is a tenth more or less.
PARTS = {
    SCANS: {"more": (1.45, 1.6), "full": (0.88, 0.91), "most": (0.6, 0.65), "third": (0.3, 0.4), "none": (0.0, 0.0)},
    POSES: {"more": (1.3, 1.4), "full": (0.86, 0.88), "most": (0.7, 0.73), "third": (0.3, 0.4), "none": (0.0, 0.0)},
}
STEADY = 1.9  # seconds after a change in which a report may be of both rates; a change follows a report
REPORTS = 3  # one of which must be right: a busy machine may count a little early or late
RATE_WITHIN = 0.2  # parts of a rate, and one message
FIRST_REPORT = 3.3  # seconds
TEXT_POINTS = "count what comes, look once a second, begin to count anew"


@exercise("debugging-7", "A monitor", points=5, level="project", timeout=45, node_class="Monitor")
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
    silence = _Phase(dict.fromkeys(WANTED, "none"), dict.fromkeys(WANTED, 0.0))
    silence.look_at(heard.arrivals)
    phases = [silence, *(_run(phase, publishers, heard) for phase in _phases())]
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
class _Phase:
    """A time in which the rates are steady, and what was reported of them then."""

    kinds: Mapping[str, str]
    rates: Mapping[str, float]  # Hz
    levels: dict[str, list[str]] = field(default_factory=lambda: {topic: [] for topic in WANTED})
    texts: dict[str, list[str | None]] = field(default_factory=lambda: {topic: [] for topic in WANTED})
    sent: dict[str, list[int]] = field(default_factory=lambda: {topic: [] for topic in WANTED})  # when, ns
    # What was sent in the second before a report, Hz: a busy machine does not get to all.
    truly: dict[str, list[float]] = field(default_factory=lambda: {topic: [] for topic in WANTED})

    def look_at(self, reports: list[tuple[int, Any]]) -> None:
        """Note what some reports say, each with when it came in ns."""
        for when, report in reports:
            for status in report.status:
                if status.name in WANTED:
                    self.levels[status.name].append(LEVELS.get(bytes(status.level), "?"))
                    text = next((pair.value for pair in status.values if pair.key == "rate"), None)
                    self.texts[status.name].append(text)
                    self.truly[status.name].append(sum(when - 1e9 < each <= when for each in self.sent[status.name]))

    @property
    def is_right(self) -> bool:
        """Whether nothing is wrong with it."""
        return not (self.wrong_rates() or any(self.wrong_levels(level) for level in LEVELS.values()))

    def wrong_levels(self, wanted: str) -> list[str]:
        """Of the topics that should have this level, those that never had it, in words."""
        return [
            f"While {self._came(topic)} it said {(seen or ['nothing'])[-1]}."
            for topic, seen in self.levels.items()
            if LEVEL_OF[self.kinds[topic]] == wanted and wanted not in seen
        ]

    def wrong_rates(self) -> list[str]:
        """The topics whose rate was never told, in words."""
        return [
            f"While {self._came(topic)}, `rate` was {_quoted(seen)}."
            for topic, seen in self.texts.items()
            if not any(
                text is not None and (_is_about(text, self.rates[topic]) or _is_about(text, truly))
                for text, truly in zip(seen, self.truly[topic], strict=True)
            )
        ]

    def _came(self, topic: str) -> str:
        return f"{self.rates[topic]:.1f} of {WANTED[topic]:g} messages a second came on {topic}"


def _phases() -> list[_Phase]:
    """Five pairs of rates: each topic has each kind once, never both the same level, at first never none."""
    while True:
        scans, poses = (chance().sample(sorted(LEVEL_OF), len(LEVEL_OF)) for _ in WANTED)
        pairs = list(zip(scans, poses, strict=True))
        if "none" not in pairs[0] and all(LEVEL_OF[a] != LEVEL_OF[b] for a, b in pairs):
            break
    phases = [{SCANS: a, POSES: b} for a, b in pairs]
    return [
        _Phase(kinds, {topic: WANTED[topic] * chance().uniform(*PARTS[topic][kinds[topic]]) for topic in WANTED})
        for kinds in phases
    ]


def _run(phase: _Phase, publishers: Mapping[str, Any], heard: Heard) -> _Phase:
    """Publish at the rates of a phase until a report is right, or some are not."""
    began, since = time.monotonic(), time.time_ns() + int(STEADY * 1e9)
    due = {topic: began + chance().random() / rate for topic, rate in phase.rates.items() if rate}
    messages = {SCANS: LaserScan(ranges=[1.0]), POSES: Pose()}
    seen = 0
    while seen < REPORTS and time.monotonic() < began + STEADY + REPORTS + 1:
        now = time.monotonic()
        for topic in [topic for topic, when in due.items() if when <= now]:
            publishers[topic].publish(messages[topic])
            phase.sent[topic].append(time.time_ns())
            due[topic] += 1 / phase.rates[topic]
        if len(new := [when for when in heard.times if when >= since]) > seen:
            phase.look_at([(when, report) for when, report in heard.arrivals if when >= since][seen : len(new)])
            seen = len(new)
            if phase.is_right:
                break
        pause(max(0.0, min([*due.values(), now + 0.05]) - time.monotonic()))
    return phase


def _is_about(text: str, rate: float) -> bool:
    """Whether a text has a number that is this rate, with a unit or without; for 0 also none, as of nothing."""
    found = re.search(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", text.lower())
    if found is None:
        return rate == 0.0
    return abs(float(found[0]) - rate) <= (1.0 + RATE_WITHIN * rate if rate else 0.5)


def _quoted(texts: list[str | None]) -> str:
    return "missing" if not texts or texts[-1] is None else repr(texts[-1])


def _first(wrong: list[str]) -> str:
    return wrong[0] if wrong else ""
