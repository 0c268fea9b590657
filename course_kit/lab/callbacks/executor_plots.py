"""A node's callbacks, their groups and the executor that runs them, as a picture drawn from the node that runs."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch, Rectangle
from rclpy.node import Node

from course_kit.base.arguments import TEXT, shown, takes
from course_kit.base.figures import COLOURS, FAINT, INK, LINES, PANEL, Plot, as_ink
from course_kit.lab.callbacks.callback_groups import Callback, Execution, Group
from course_kit.lab.callbacks.node_callbacks import execution_of

COLOUR_OF = {
    "timer": COLOURS[4], "subscription": COLOURS[5], "service": COLOURS[0], "client": COLOURS[1],
    "action client": COLOURS[3], "action server": COLOURS[2],
}  # fmt: skip
WIDTH, ROW = 10.4, 0.36  # inches; the axes have the same units
QUEUE, GROUP, GROUP_END, THREADS = 2.75, 3.5, 7.5, 8.3
MOST_THREADS = 8  # that are drawn


@takes(title=TEXT | None)
def plot_executor(node: Node, title: str | None = None) -> Plot:
    """What makes the callbacks of a node due, the groups that they are in, and the threads that may run them.

    Raises TypeError for what is no node. The picture's sentence is its alternative text, too: `plot.description`.
    """
    if not isinstance(node, Node):
        raise TypeError(f"plot_executor() draws a node, as run() returns it, not {shown(node)}")
    return draw_execution(execution_of(node), title)


def draw_execution(execution: Execution, title: str | None = None) -> Plot:
    """The picture of what was read from a node."""
    rows = sum(len(group.callbacks) + 1.7 + bool(group.others) for group in execution.groups)
    height = max(rows, min(execution.threads, MOST_THREADS) + 2.2) * ROW
    plot = Plot(WIDTH, height + 1.2, title or f"What runs the callbacks of {execution.node}")
    axes = plot.subplots()
    axes.set(xlim=(-0.1, WIDTH), ylim=(height + 0.55, -0.6))
    axes.axis("off")
    for x, text in ((0.0, "what is waited for, and its queue"), (GROUP, "callbacks, by group"), (THREADS, "executor")):
        axes.text(x, -0.3, text, color=INK, fontsize=10, fontweight="bold", va="center")
    _draw_executor(axes, execution, height)
    top = 0.0
    for group in execution.groups:
        bottom = _draw_group(axes, group, top)
        _arrow(axes, (GROUP_END + 0.06, (top + bottom) / 2), (THREADS - 0.1, height / 2))
        top = bottom + 0.7 * ROW
    axes.text(0.0, height + 0.35, execution.at_once, color=INK, fontsize=10.5, va="center")
    plot.description = _in_words(execution)
    return plot


def _draw_group(axes: Axes, group: Group, top: float) -> float:
    """A group's box, with what each callback of it waits for; where it ends."""
    bottom = top + (len(group.callbacks) + 1.15 + bool(group.others)) * ROW
    edge = COLOURS[2] if group.is_reentrant else FAINT
    _box(axes, (GROUP, top, GROUP_END, bottom), PANEL, edge, dashed=group.is_reentrant)
    rule = f"{group.title}: {group.rule}"
    axes.text(GROUP + 0.12, top + 0.5 * ROW, rule, color=as_ink(edge), fontsize=8, va="center")
    for number, callback in enumerate(group.callbacks, 1):
        _draw_callback(axes, callback, top + (number + 0.5) * ROW)
    if group.others:
        text = f"and {group.others} services that every node has"
        axes.text(GROUP + 0.12, bottom - 0.5 * ROW, text, color=FAINT, fontsize=8.5, va="center", style="italic")
    return bottom


def _draw_callback(axes: Axes, callback: Callback, y: float) -> None:
    colour = COLOUR_OF[callback.kind]
    axes.text(0.0, y, callback.cause, color=INK, fontsize=9, va="center")
    for slot in range(1 if callback.kind == "timer" else 3):
        place = (QUEUE - slot * 0.14 - 0.12, y - 0.08)
        axes.add_patch(Rectangle(place, 0.12, 0.16, facecolor=PANEL, edgecolor=colour, linewidth=1.1))
    _arrow(axes, (QUEUE + 0.05, y), (GROUP + 0.1, y), colour)
    _box(axes, (GROUP + 0.14, y - 0.36 * ROW, GROUP_END - 0.14, y + 0.36 * ROW), "#f1f1ee", colour)
    axes.text(GROUP + 0.25, y, callback.kind, color=FAINT, fontsize=8.5, va="center")
    axes.text(GROUP + 1.35, y, callback.function, color=INK, fontsize=9, va="center", family="monospace")


def _draw_executor(axes: Axes, execution: Execution, height: float) -> None:
    _box(axes, (THREADS, 0.0, WIDTH - 0.1, height), PANEL, INK)
    name = execution.executor or "none"
    axes.text(THREADS + 0.1, 0.5 * ROW, name, color=INK, fontsize=8, va="center")
    shown_threads = min(execution.threads, MOST_THREADS)
    for number in range(shown_threads):
        y = height / 2 + (number - (shown_threads - 1) / 2) * ROW * 1.1 + 0.25 * ROW
        _box(axes, (THREADS + 0.2, y - 0.38 * ROW, WIDTH - 0.3, y + 0.38 * ROW), "#e6eef5", COLOURS[0])
        text = f"thread {number + 1}"
        if number == MOST_THREADS - 1 < execution.threads - 1:
            text = f"… {execution.threads} threads"
        axes.text((THREADS + WIDTH - 0.1) / 2, y, text, color=INK, fontsize=9, va="center", ha="center")


def _box(
    axes: Axes, sides: tuple[float, float, float, float], face: str, edge: str = LINES, dashed: bool = False
) -> None:
    left, top, right, bottom = sides
    place, outline = (left, top), "round,pad=0,rounding_size=0.06"
    shape = FancyBboxPatch(place, right - left, bottom - top, outline, facecolor=face, edgecolor=edge, linewidth=1.2)
    shape.set_linestyle("--" if dashed else "-")
    axes.add_patch(shape)


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str = FAINT) -> None:
    look = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=look)


def _in_words(execution: Execution) -> str:
    groups = [
        f"{group.title} ({group.rule}): "
        + ", ".join(f"{one.kind} {one.function} ({one.cause})" for one in group.callbacks)
        for group in execution.groups
    ]
    return f"{execution.node}. {'; '.join(groups)}. {execution.at_once}"
