"""Rates, bandwidth, delay and log lines of many topics at once, live."""

from __future__ import annotations

from typing import Any

from course_kit.base.arguments import SPAN, takes
from course_kit.lab.node_logs import rosout
from course_kit.lab.recordings import rates
from course_kit.lab.recordings.rate_statistics import Reading
from course_kit.lab.recordings.rates import RateMeter, bandwidth_text, delay_text
from course_kit.ros.graph import graph
from course_kit.ros.spinning import context
from course_kit.ros.subscriptions import observer_node, topics
from course_kit.views.live.shown import Bundle
from course_kit.views.live.view import LONGEST, LiveView, as_tables

PERIOD = 0.5  # seconds between two tables
HEADINGS = ("topic", "from", "rate", "period min", "max", "delay", "bandwidth", "lost", "age")
QUIET = 2.0  # seconds without a message after which a topic is said to be silent


@takes(last=SPAN, period=SPAN, seconds=SPAN)
def watch_rates(*wanted: Any, last: float = 3.0, period: float = PERIOD, seconds: float = LONGEST) -> LiveView:
    """Show a table of rates, bandwidths and delays, live: `ros2 topic hz`, `bw` and `delay` for many topics at once.

    Without topics, all that nodes publish, also those that come later. The numbers are about the `last` seconds.
    Below stands how many lines each node logs a second. It ends with .stop(), with the next run of its cell, or
    after `seconds`.
    """
    context.start()
    rosout.collect()
    types = topics.look_up(observer_node.node(), topics.with_types(wanted), 10.0) if wanted else {}
    meter = RateMeter(types, rates.WINDOW)

    def draw() -> Bundle:
        if not wanted:
            _add_new(meter)
        return as_tables(rates_tables(meter, last), left=2)

    return LiveView("rates", draw, meter.stop, period, seconds)


def _add_new(meter: RateMeter) -> None:
    """Measure what is published since the last look."""
    node = observer_node.node()
    for topic in topics.published(node):
        types = {publisher.topic_type for publisher in topics.publishers(node, topic)}
        if topic in meter.topics or graph.is_hidden(topic) or len(types) != 1:
            continue
        try:
            meter.add(topic, topics.message_class(types.pop()))
        except (ImportError, ValueError, TypeError):  # a type that is not built here, or two types
            continue


def rates_tables(meter: RateMeter, last: float) -> list[str | list[tuple[str, ...]]]:
    """The present table, with the log lines of each node below it."""
    rows = [(topic, *_row(topic, reading)) for topic, reading in sorted(meter.read(last).items())]
    logged = rosout.log_rates(max(last, 1.0))
    shown: list[str | list[tuple[str, ...]]] = [[HEADINGS, *rows] if rows else "(no node publishes anything)"]
    return [*shown, logged.rows()] if logged else shown


def _row(topic: str, reading: Reading) -> tuple[str, ...]:
    publishers = sorted({topics.node_name(one) for one in topics.publishers(observer_node.node(), topic)})
    who = publishers[0] if len(publishers) == 1 else f"{len(publishers)} nodes" if publishers else "nobody"
    lost, age = f"{reading.lost:,}", f"{reading.age:.1f} s"
    if not reading.messages:
        return (who, "-", "-", "-", "-", "-", lost, "none came")
    if reading.window < 2:
        return (who, "silent" if reading.age > QUIET else "-", "-", "-", "-", "-", lost, age)
    period = (f"{value * 1e3:.1f} ms" for value in (reading.period.min, reading.period.max))
    delay = delay_text(reading.delay.mean)
    return (who, f"{reading.rate:,.1f} Hz", *period, delay, bandwidth_text(reading.bandwidth), lost, age)
