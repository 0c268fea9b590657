"""Calls as a sequence diagram: sender, receiver and time, which runs down the page, to scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from course_kit.base.arguments import TEXT, takes
from course_kit.base.figures import COLOURS, FAINT, INK, PANEL, Plot, legend, style
from course_kit.lab.calls.service_calls import Call, calls_of
from course_kit.lab.recordings.recording import Recording
from course_kit.lab.recordings.topic_recording import TopicRecording

BAR = 0.03  # width of a bar, in distances between two lifelines
NEXT_LINE = "\n  "  # of a legend


@dataclass(frozen=True)
class Arrow:
    """A message from one lifeline to another; `received` is nan if it never arrived. Seconds."""

    source: str
    target: str
    sent: float
    received: float
    colour: str = COLOURS[0]
    label: str = ""


@dataclass(frozen=True)
class Bar:
    """A time in which a lifeline works, waits (hollow) or lets something lie in a queue (hatched). Seconds."""

    lifeline: str
    began: float
    ended: float
    colour: str = COLOURS[0]
    is_hollow: bool = False
    slot: int = 0  # side by side; hollow bars go to the left, the others to the right
    is_hatched: bool = False


def plot_sequence(
    lifelines: Sequence[str], arrows: Sequence[Arrow], bars: Sequence[Bar] = (), title: str | None = None
) -> Plot:
    """Lifelines from left to right, arrows between them and bars on them, over the time since the first event.

    Raises ValueError if there is no arrow.
    """
    if not arrows:
        raise ValueError("there is no message to draw: nothing was sent while it was recorded")
    start = min(arrow.sent for arrow in arrows)
    known = [t for a in arrows for t in (a.sent, a.received)] + [t for b in bars for t in (b.began, b.ended)]
    span = max(t for t in known if not math.isnan(t)) - start
    scale, unit = (1e3, "ms") if span < 2.0 else (1.0, "s")
    end = max(span * scale, 1e-3)
    plot = Plot(9.0, 4.6, title)
    axes = style(plot.subplots(), ylabel=f"time since the first request [{unit}]")
    place = {name: float(number) for number, name in enumerate(lifelines)}
    for name, x in place.items():
        axes.axvline(x, color=FAINT, linewidth=1.0, linestyle="--", zorder=1)
        axes.annotate(
            name, (x, 1.0), (0, 8), xycoords=("data", "axes fraction"), textcoords="offset points",
            ha="center", color=INK, fontsize=10.5, fontweight="bold",
        )  # fmt: skip
    for bar in bars:
        _draw_bar(axes, bar, place[bar.lifeline], start, scale, end)
    for arrow in arrows:
        _draw_arrow(axes, arrow, place, start, scale, end)
    axes.set_xlim(-0.35, len(lifelines) - 0.65)
    axes.set_ylim(end * 1.06, -end * 0.06)
    axes.set_xticks([])
    axes.spines["bottom"].set_visible(False)
    legend(axes, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return plot


def _draw_bar(axes: Axes, bar: Bar, x: float, start: float, scale: float, end: float) -> None:
    began = (bar.began - start) * scale
    ended = end * 1.06 if math.isnan(bar.ended) else (bar.ended - start) * scale
    side = -1 if bar.is_hollow else 1
    left = x + side * bar.slot * BAR * 1.3 - BAR / 2
    face = PANEL if bar.is_hollow or bar.is_hatched else bar.colour
    shape = Rectangle((left, began), BAR, ended - began, facecolor=face, edgecolor=bar.colour, linewidth=1.3, zorder=2)
    if bar.is_hatched:
        shape.set_hatch("////")
    axes.add_patch(shape)


def _draw_arrow(axes: Axes, arrow: Arrow, place: dict[str, float], start: float, scale: float, end: float) -> None:
    x, to = place[arrow.source], place[arrow.target]
    lost = math.isnan(arrow.received)
    sent = (arrow.sent - start) * scale
    received = sent if lost else (arrow.received - start) * scale
    if lost:
        to = (x + to) / 2
        axes.plot([to], [sent], marker="x", markersize=9, markeredgewidth=2, color=arrow.colour, zorder=4)
    look = {"arrowstyle": "-|>", "color": arrow.colour, "linewidth": 1.7, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (to, received), (x, sent), arrowprops=look, zorder=3)
    if arrow.label:
        axes.plot([], [], color=arrow.colour, linewidth=1.7, label=arrow.label)


@takes(title=TEXT | None)
def plot_calls(recorded: Recording | TopicRecording, title: str | None = None) -> Plot:
    """The calls of one service, client on the left and server on the right, from its recorded `_service_event`.

    Hollow bars: the client waits; hatched: the request lies in the server's queue; filled: the server works. When a
    request arrives, nobody reports: one that found the server busy is drawn as if it arrived at once. Raises ValueError
    for another type, for several topics and for an empty recording.
    """
    if not isinstance(recorded, Recording | TopicRecording):
        raise TypeError(f"plot_calls() draws what record() returns, not {type(recorded).__name__}")
    topics = [recorded] if isinstance(recorded, TopicRecording) else list(recorded)
    if len(topics) != 1 or not topics[0].topic.endswith("/_service_event"):
        names = ", ".join(one.topic for one in topics)
        raise ValueError(f"plot_calls() draws the topic <service>/_service_event of one service, not {names}")
    calls = calls_of(topics[0].messages)
    if not calls:
        raise ValueError(
            f"the recording of {topics[0].topic} is empty: was the service called meanwhile, and has its client or "
            f"server configure_introspection(...)?"
        )
    arrows: list[Arrow] = []
    bars: list[Bar] = []
    for slot, call in enumerate(calls):
        colour = COLOURS[slot % len(COLOURS)]
        queued = call.queued_among(calls)
        asked = call.began if math.isnan(call.request_sent) else call.request_sent
        arrived = asked if queued else call.request_received
        arrows.append(Arrow("client", "server", asked, arrived, colour, _describe(call, slot + 1, queued)))
        bars.append(Bar("client", asked, call.response_received, colour, is_hollow=True, slot=slot))
        if not math.isnan(call.request_received):
            there = {bar.slot for bar in bars if bar.lifeline == "server" and not bar.ended <= arrived}
            beside = min(set(range(len(there) + 1)) - there)
            if queued:
                bars.append(Bar("server", arrived, call.request_received, colour, slot=beside, is_hatched=True))
            bars.append(Bar("server", call.request_received, call.response_sent, colour, slot=beside))
        if not math.isnan(call.response_sent):
            arrows.append(Arrow("server", "client", call.response_sent, call.response_received, colour))
    service = topics[0].topic.removesuffix("/_service_event")
    plot = plot_sequence(("client", "server"), arrows, bars, title or f"Calls of {service}")
    start = min(arrow.sent for arrow in arrows)
    told = [f"After {_ms(one.sent - start)}, {one.label.replace(NEXT_LINE, ', ')}." for one in arrows if one.label]
    plot.description = " ".join([f"Calls of {service}, from its client to its server.", *told])
    return plot


def _describe(call: Call, number: int, queued: bool) -> str:
    if math.isnan(call.duration):
        return f"call {number}: no response"
    waited = f"{_ms(call.waiting)} {'in the queue' if queued else 'until served'}"
    return NEXT_LINE.join((f"call {number}: {_ms(call.duration)}", waited, f"{_ms(call.working)} served"))


def _ms(seconds: float) -> str:
    milliseconds = seconds * 1e3
    return f"{milliseconds:.2f} ms" if milliseconds < 10 else f"{milliseconds:.0f} ms"
