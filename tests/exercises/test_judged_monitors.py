"""Verdicts of the check of debugging-7 on reports that came late, or behind messages that went out late."""

from __future__ import annotations

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from course_kit.exercises.debugging.debugging_7_monitor import POSES, SCANS, Phase

RATE = 8.5  # Hz of the scans
S = 1_000_000_000  # ns
SCAN_TIMES = [int(S * number / RATE) for number in range(60)]


def phase(reports: list[float], needed: int, sent: list[int] | None = None, held: float = 0.0) -> Phase:
    """A phase with reports at some times (s) of a monitor that calls so many scans (since its last report) OK.

    The scans of the last `held` seconds before the report at 2 s reach it after that, and count in the next one.
    """
    seen = Phase({SCANS: "full", POSES: "none"}, {SCANS: RATE, POSES: 0.0})
    seen.sent[SCANS] = sent or SCAN_TIMES
    arrivals = []
    for before, when in zip([reports[0] - 1, *reports], reports, strict=False):
        came = sum(before * S < each <= when * S for each in seen.sent[SCANS])
        if when == 3.0:
            came += sum((before - held) * S < each <= before * S for each in seen.sent[SCANS])
        scans = DiagnosticStatus(name=SCANS, level=DiagnosticStatus.OK if came >= needed else DiagnosticStatus.WARN)
        scans.values.append(KeyValue(key="rate", value=str(float(came))))
        poses = DiagnosticStatus(name=POSES, level=DiagnosticStatus.STALE)
        arrivals.append((int(when * S), DiagnosticArray(status=[scans, poses])))
    seen.look_at(arrivals, since=int(1.9 * S))
    return seen


@pytest.mark.parametrize("needed", [8, 10])
def test_a_late_report_does_not_count_beside_those_in_time(needed: int) -> None:
    seen = phase([1.0, 2.0, 3.2, 4.2], needed)
    assert [each.level for each in seen.said[SCANS]][1] == "OK"
    assert (not seen.wrong_levels("OK")) == (needed == 8)
    assert not seen.wrong_levels("STALE")


@pytest.mark.parametrize("needed", [8, 10])
def test_a_report_behind_late_messages_does_not_count(needed: int) -> None:
    late = [3 * S + 1 if 2.7 * S < each <= 3 * S else each for each in SCAN_TIMES]
    seen = phase([1.0, 2.0, 3.0, 4.0], needed, late)
    assert [each.level for each in seen.said[SCANS]][2] == "OK"
    assert (not seen.wrong_levels("OK")) == (needed == 8)


@pytest.mark.parametrize("needed", [8, 10])
def test_a_report_of_more_than_came_does_not_count(needed: int) -> None:
    seen = phase([1.0, 2.0, 3.0, 4.0], needed, held=0.3)
    assert [each.level for each in seen.said[SCANS]][1] == "OK"
    assert (not seen.wrong_levels("OK")) == (needed == 8)


def test_late_reports_count_where_none_was_in_time() -> None:
    seen = phase([1.0, 2.2, 3.4, 4.6], needed=10)
    assert seen.is_late
    assert not seen.wrong_levels("OK")


def test_a_monitor_that_is_in_time_needs_no_more_of_it() -> None:
    assert not phase([1.0, 2.0, 3.0], needed=8).is_late
