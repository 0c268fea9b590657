"""The resources of nodes' processes over time, beside the rates of topics, as a picture."""

from __future__ import annotations

from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from course_kit.base.alternative_text import span
from course_kit.base.arguments import TEXT, takes
from course_kit.base.figures import COLOURS, FAINT, Plot, legend, style
from course_kit.lab.recordings.plots import arrivals_of
from course_kit.lab.recordings.rate_statistics import Int64s, rate_over_time
from course_kit.lab.recordings.rates import RateMeter
from course_kit.lab.recordings.recording import Recording
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.lab.resources.resource_recording import ResourceRecording, Usage

BESIDE = {"loc": "upper left", "bbox_to_anchor": (1.005, 1.03), "ncols": 1}


@takes(title=TEXT | None)
def plot_resources(
    recorded: ResourceRecording, *measured: Recording | TopicRecording | RateMeter, title: str | None = None
) -> Plot:
    """CPU and memory of each process with nodes over time; below them the rates of topics that were measured meanwhile.

    Takes what record_resources() returned, and recordings and rate meters. Threads of nodes in the notebook are drawn
    dashed. Raises ValueError before the second sample.
    """
    if not isinstance(recorded, ResourceRecording):
        raise TypeError(f"plot_resources() draws what record_resources() returns, not {type(recorded).__name__}")
    # Processes first, then threads: those have the colours with most contrast.
    usages = sorted((one for one in recorded.values() if len(one)), key=lambda one: one.is_thread)
    if not usages:
        raise ValueError("nothing was measured: is a node running, and was there time for two looks?")
    arrivals = {name: ns for name, ns in arrivals_of(measured).items() if len(ns) > 1 and ns[-1] > ns[0]}
    heights = [2.2, 1.9, *([2.0] if arrivals else [])]
    plot = Plot(10.4, 0.8 + sum(heights), title or "Resources")
    rows = plot.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    style(rows[0], ylabel="CPU [% of a core]")
    style(rows[1], ylabel="memory [MB]")
    for one, colour in zip(usages, cycle(COLOURS), strict=False):
        _draw(rows[0], rows[1], one, colour, recorded.start_ns)
    rows[0].set_ylim(bottom=0)
    rows[1].set_ylim(0, rows[1].get_ylim()[1] * 1.05)
    legend(rows[0], **BESIDE)  # the memory has the same colours
    if arrivals:
        _draw_rates(style(rows[2], ylabel="rate [Hz]"), arrivals, recorded.start_ns)
    ends = [one.when_ns[-1] for one in usages]
    rows[-1].set_xlim(0, max((max(ends) - recorded.start_ns) * 1e-9, 1e-3))
    rows[-1].set_xlabel("time since the start [s]", fontsize=10)
    plot.align_ylabels()
    told = [_in_words(one) for one in usages]
    told += [f"{name}: {span(rate_over_time(receive_ns)[1], 'Hz')}." for name, receive_ns in arrivals.items()]
    plot.description = " ".join(told)
    return plot


def _name(usage: Usage) -> str:
    if usage.is_thread:
        return f"thread of {usage.label}"
    return usage.label if len(usage.nodes) != 1 else f"{usage.nodes[0]} ({usage.pid})"


def _in_words(usage: Usage) -> str:
    cpu = f"CPU {span(usage.cpu, '% of a core')}, {np.nanmean(usage.cpu):.3g} % in the mean"
    memory = "" if usage.is_thread else f", memory {span(usage.memory, 'MB')}"
    return f"{_name(usage)}: {cpu}{memory}."


def _draw(cpu: Axes, memory: Axes, usage: Usage, colour: str, start_ns: int) -> None:
    seconds = (usage.when_ns - start_ns) * 1e-9
    if usage.is_thread:
        cpu.plot(seconds, usage.cpu, color=colour, linewidth=1.4, linestyle="--", label=_name(usage))
        return
    cpu.plot(seconds, usage.cpu, color=colour, linewidth=1.7, label=_name(usage))
    memory.plot(seconds, usage.memory, color=colour, linewidth=1.7)


def _draw_rates(axes: Axes, arrivals: dict[str, Int64s], start_ns: int) -> None:
    highest, lowest = 0.0, np.inf
    for colour, (name, receive_ns) in zip(cycle(COLOURS), arrivals.items(), strict=False):
        edges, hertz = rate_over_time(receive_ns)
        after = (int(receive_ns[0]) - start_ns) * 1e-9
        axes.stairs(hertz, edges + after, baseline=None, color=colour, linewidth=1.6, label=name)
        highest, lowest = max(highest, float(hertz.max())), min(lowest, float(hertz.max()))
    if highest > 20 * lowest:  # a slow topic beside a fast one would lie on the axis
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter("{x:,.4g}")
    else:
        axes.set_ylim(0, highest * 1.2)
    axes.tick_params(colors=FAINT)
    legend(axes, **BESIDE)
