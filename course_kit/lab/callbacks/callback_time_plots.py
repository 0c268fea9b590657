"""The callbacks of programs over time, a row for each thread, and how long a response lay in its queue, as pictures."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes

from course_kit.base.arguments import TEXT, shown, takes
from course_kit.base.figures import AMBER, COLOURS, FAINT, INK, Plot, as_ink, style
from course_kit.base.programs.child_process import Process
from course_kit.lab.callbacks.callback_times import Run, Span, run_of

BUSY, WAITING, TAKEN = AMBER, COLOURS[1], COLOURS[2]
BRIEF = 0.01  # of the longest run: what is shorter is drawn as a mark
LANE = 0.3  # inches


@takes(title=TEXT | None)
def plot_callback_times(programs: Sequence[Process], arrived: Sequence[float], title: str | None = None) -> Plot:
    """The callbacks of programs that have printed them, side by side on one axis of time.

    Each program prints what callback_times.py reads; its last callback takes the response that was sent at the time
    that `arrived` has for it, so until then the response lay in the queue. Raises TypeError for other arguments,
    ValueError for a program that printed nothing of the kind or if there is not one time for each.
    """
    runs = [(process.name, run_of(process.lines)) for process in _programs(programs)]
    times = _times(arrived)
    if len(times) != len(runs):
        raise ValueError(f"plot_callback_times() needs one time for each program, not {len(times)} for {len(runs)}")
    lanes = [run.threads + 1 for _, run in runs]
    plot = Plot(9.6, 0.9 + sum(lanes) * LANE + 0.5 * len(runs), title)
    rows = plot.subplots(len(runs), 1, sharex=True, height_ratios=[count + 0.4 for count in lanes], squeeze=False)
    longest = max(run.spans[-1].ended - run.spans[0].began for _, run in runs)
    for axes, (name, run), time in zip(rows[:, 0], runs, times, strict=True):
        _draw(style(axes, title=name), run, time, longest)
    rows[-1, 0].set_xlabel("time since the callback began [s]", color=INK, fontsize=10)
    rows[-1, 0].set_xlim(-0.02 * longest, 1.22 * longest)
    plot.description = " ".join(_in_words(name, run, time) for (name, run), time in zip(runs, times, strict=True))
    return plot


def _programs(programs: Sequence[Process]) -> list[Process]:
    if not isinstance(programs, list | tuple) or not all(isinstance(one, Process) for one in programs):
        raise TypeError(
            f"plot_callback_times() draws a list of programs, as start() returns them, not {shown(programs)}"
        )
    if not programs:
        raise ValueError("plot_callback_times() needs at least one program")
    return list(programs)


def _times(arrived: Sequence[float]) -> list[float]:
    if not isinstance(arrived, list | tuple) or not all(isinstance(one, float) for one in arrived):
        raise TypeError(f"arrived must be a list of times in seconds, not {shown(arrived)}")
    return list(arrived)


def _draw(axes: Axes, run: Run, arrived: float, longest: float) -> None:
    start, queue = run.spans[0].began, run.threads
    for span in run.spans:
        _draw_span(axes, span, start, longest)
    taken = run.spans[-1].began
    axes.barh(
        queue, taken - arrived, left=arrived - start, height=0.6, facecolor="none", edgecolor=WAITING, hatch="///"
    )
    waited = f"waited {taken - arrived:.1f} s" if taken - arrived > BRIEF * longest else "taken at once"
    axes.annotate(
        waited, (taken - start, queue), (6, 0), textcoords="offset points",
        va="center", color=as_ink(WAITING), fontsize=9,
    )  # fmt: skip
    labels = [f"thread {number + 1}" for number in range(run.threads)]
    axes.set_yticks(range(run.threads + 1), [*labels, "response in the queue"])
    axes.set_ylim(run.threads + 0.6, -0.6)
    axes.grid(axis="y", visible=False)
    axes.tick_params(axis="x", labelbottom=axes.get_subplotspec().is_last_row())  # type: ignore[union-attr]


def _draw_span(axes: Axes, span: Span, start: float, longest: float) -> None:
    lane, length = span.thread - 1, span.ended - span.began
    if length > BRIEF * longest:
        axes.barh(lane, length, left=span.began - start, height=0.6, facecolor=BUSY, edgecolor=FAINT, linewidth=0.8)
        middle = span.began - start + length / 2
        axes.text(middle, lane, span.name, color=INK, fontsize=9, ha="center", va="center")
    else:
        axes.plot([span.began - start], [lane], marker="v", color=TAKEN, markersize=8, linestyle="", zorder=3)
        axes.annotate(
            span.name, (span.began - start, lane), (8, 0), textcoords="offset points",
            va="center", color=as_ink(TAKEN), fontsize=9,
        )  # fmt: skip


def _in_words(name: str, run: Run, arrived: float) -> str:
    first, last = run.spans[0], run.spans[-1]
    return (
        f"{name}: {first.name} ran for {first.ended - first.began:.1f} s, the response came after "
        f"{arrived - first.began:.1f} s and was taken after {last.began - first.began:.1f} s."
    )
