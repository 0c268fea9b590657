"""Goals of an action as pictures: their state machine, their lives over time."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import FancyBboxPatch, Patch

from course_kit.base.arguments import TEXT, takes
from course_kit.base.figures import AMBER, COLOURS, FAINT, INK, PANEL, SKY, Plot, as_ink, legend, style
from course_kit.lab.calls.goals import ENDS, Goal, goals_of
from course_kit.lab.recordings.recording import Recording

SERVER, CLIENT = COLOURS[0], COLOURS[1]  # who brings a change about
OF_STATE = {"ACCEPTED": "#c9c9c2", "EXECUTING": SKY, "CANCELING": AMBER}
OF_END = {"SUCCEEDED": COLOURS[2], "CANCELED": COLOURS[1], "ABORTED": "#a50026"}
# Where the states stand, and the changes between them: from, to, label, place of the label along the arrow, by whom.
PLACES = {
    "ACCEPTED": (1.9, 0.0), "EXECUTING": (4.7, 1.0), "CANCELING": (4.7, -1.0),
    "SUCCEEDED": (8.6, 1.7), "ABORTED": (8.6, 0.0), "CANCELED": (8.6, -1.7),
}  # fmt: skip
CHANGES = (
    ("ACCEPTED", "EXECUTING", "execute()", 0.5, SERVER),
    ("ACCEPTED", "CANCELING", "cancel", 0.5, CLIENT),
    ("EXECUTING", "CANCELING", "cancel", 0.5, CLIENT),
    ("EXECUTING", "SUCCEEDED", "succeed()", 0.45, SERVER),
    ("EXECUTING", "ABORTED", "abort()", 0.26, SERVER),
    ("CANCELING", "SUCCEEDED", "succeed()", 0.3, SERVER),
    ("CANCELING", "ABORTED", "abort()", 0.62, SERVER),
    ("CANCELING", "CANCELED", "canceled()", 0.5, SERVER),
)
WIDTH, HEIGHT = 1.66, 0.56  # of a state's box


def plot_goal_states() -> Plot:
    """The states of a goal, and what takes it from one to the next: calls of the server, requests of the client."""
    plot = Plot(9.4, 3.9, "The life of a goal")
    axes = plot.subplots()
    axes.set_axis_off()
    axes.set_xlim(-0.55, 9.6)
    axes.set_ylim(-2.5, 2.25)
    axes.plot([-0.1], [0.0], marker="o", markersize=11, color=INK)
    _draw_change(axes, (0.0, 0.0), (1.9 - WIDTH / 2, 0.0), "", 0.5, SERVER)
    axes.text(0.47, 0.16, "goal accepted", color=INK, fontsize=9, ha="center", va="bottom")
    _draw_change(axes, (-0.1, -0.1), (-0.1, -1.25), "", 0.5, SERVER)
    axes.text(-0.32, -1.5, "rejected:\nnever a goal", color=INK, fontsize=9, va="top")
    for start, end, label, place, colour in CHANGES:
        _draw_change(axes, *_between(start, end), label, place, colour)
    for name, (x, y) in PLACES.items():
        edge = OF_END.get(name, FAINT)
        face = OF_STATE.get(name, PANEL)
        corner = (x - WIDTH / 2, y - HEIGHT / 2)
        shape = FancyBboxPatch(
            corner, WIDTH, HEIGHT, "round,pad=0,rounding_size=0.14",
            facecolor=face, edgecolor=edge, linewidth=2.2 if name in ENDS else 1.2, zorder=3,
        )  # fmt: skip
        axes.add_patch(shape)
        axes.text(x, y, name, ha="center", va="center", color=INK, fontsize=9.5, fontweight="bold", zorder=4)
    handles = [
        Line2D([], [], color=SERVER, linewidth=1.8, label="the server does it"),
        Line2D([], [], color=CLIENT, linewidth=1.8, label="the client asks, the server agrees"),
        Patch(facecolor=PANEL, edgecolor=OF_END["SUCCEEDED"], linewidth=2.2, label="ends of a goal"),
    ]
    legend(axes, handles=handles, loc="lower center", ncols=3)
    told = [
        f"{start} to {end} by {label} of the {'client' if colour == CLIENT else 'server'}"
        for start, end, label, _, colour in CHANGES
    ]
    plot.description = (
        f"The states of a goal. It is rejected, and never a goal, or ACCEPTED. {'; '.join(told)}. "
        f"{', '.join(ENDS)} are its ends."
    )
    return plot


def _between(start: str, end: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """Where an arrow leaves one state's box and meets another's: at their sides, or at top and bottom."""
    (x, y), (to_x, to_y) = PLACES[start], PLACES[end]
    if x == to_x:
        return (x, y - HEIGHT / 2), (to_x, to_y + HEIGHT / 2)
    return (x + WIDTH / 2, y), (to_x - WIDTH / 2, to_y)


def _draw_change(
    axes: Axes, start: tuple[float, float], end: tuple[float, float], label: str, place: float, colour: str
) -> None:
    look = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.6, "shrinkA": 1, "shrinkB": 1}
    axes.annotate("", end, start, arrowprops=look, zorder=2)
    if label:
        at = [a + place * (b - a) for a, b in zip(start, end, strict=True)]
        box = {"facecolor": axes.figure.get_facecolor(), "edgecolor": "none", "pad": 1.2}
        axes.text(at[0], at[1], label, color=INK, fontsize=9, ha="center", va="center", bbox=box, zorder=2.5)


@takes(title=TEXT | None)
def plot_goals(recorded: Recording, title: str | None = None) -> Plot:
    """One row a goal: how long it waited, was executed and was being cancelled, its feedback, and how it ended.

    Takes a recording of an action's `_action/status` and, if there is feedback to show, `_action/feedback`. Raises
    ValueError for other topics, and if no goal was active while it was recorded.
    """
    action, goals = recorded_goals(recorded)
    start = goals[0].accepted
    known = [t for goal in goals for t in (*(t for t, _ in goal.changes), *goal.feedback)]
    end = max(known) - start
    plot = Plot(9.4, 1.5 + 0.5 * len(goals), title or f"Goals of {action}")
    axes = style(plot.subplots(), xlabel="time since the first goal was accepted [s]")
    for row, goal in enumerate(goals):
        limits = [time - start for time, _ in goal.changes] + ([] if goal.ended is not None else [end])
        for (_, state), left, right in zip(goal.changes, limits, limits[1:], strict=False):
            if state in OF_STATE:
                look: dict[str, Any] = {"facecolor": OF_STATE[state], "edgecolor": FAINT, "linewidth": 0.6}
                axes.barh(row, right - left, left=left, height=0.5, **look)
        axes.plot([t - start for t in goal.feedback], [row] * len(goal.feedback), "|", color=INK, markersize=11)
        if goal.ended is not None:
            axes.annotate(
                goal.state, (goal.ended - start, row), (6, 0), textcoords="offset points",
                color=as_ink(OF_END[goal.state]), fontsize=9, fontweight="bold", va="center",
            )  # fmt: skip
    axes.set_yticks(range(len(goals)), [f"goal {number}" for number in range(1, len(goals) + 1)])
    axes.set_ylim(len(goals) - 0.5, -0.5)
    axes.set_xlim(-0.02 * end, max(end, 0.1) * 1.16)
    handles: list[Patch | Line2D] = [Patch(facecolor=c, edgecolor=FAINT, label=s) for s, c in OF_STATE.items()]
    handles.append(Line2D([], [], marker="|", linestyle="", color=INK, markersize=9, label="feedback"))
    legend(axes, handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4)
    told = [_in_words(number, goal, start) for number, goal in enumerate(goals, 1)]
    plot.description = " ".join([f"Goals of {action}.", *told])
    return plot


def _in_words(number: int, goal: Goal, start: float) -> str:
    states = ", ".join(f"{state} at {time - start:.2f} s" for time, state in goal.changes)
    count = len(goal.feedback)
    return f"Goal {number}: {states}" + (f", {count} time{'s' if count > 1 else ''} feedback." if count else ".")


def recorded_goals(recorded: Recording) -> tuple[str, list[Goal]]:
    """The action's name and its goals, from a recording of its topics. What plot_goals() raises."""
    if not isinstance(recorded, Recording):
        raise TypeError(f"a goal is drawn from what record() returns, not from {type(recorded).__name__}")
    by_topic = {one.topic: [*zip(one.receive_ns * 1e-9, one.messages, strict=True)] for one in recorded}
    status = [topic for topic in by_topic if topic.endswith("/_action/status")]
    if len(status) != 1:
        raise ValueError(f"record('<action>/_action/status') of one action is needed, not {', '.join(by_topic)}")
    action = status[0].removesuffix("/_action/status")
    goals = goals_of(by_topic[status[0]], by_topic.get(f"{action}/_action/feedback", []))
    if not goals:
        raise ValueError(f"no goal of {action} was active while it was recorded")
    return action, goals
