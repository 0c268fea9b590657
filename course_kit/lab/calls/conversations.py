"""The conversation of an action's client and server about a goal: requests noted, and drawn row by row."""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch, Rectangle
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.task import Future

from course_kit.base.arguments import TEXT, takes
from course_kit.base.figures import COLOURS, FAINT, INK, Plot, legend, style
from course_kit.lab.calls.goal_plots import OF_END, OF_STATE, recorded_goals
from course_kit.lab.calls.goals import STATES, Goal
from course_kit.lab.recordings.recording import Recording

CLIENT, SERVER = 0.0, 1.0  # where their lines stand
BAR = 0.035
SHORT = 0.1  # rows; a state that lasted less is hardly to be seen
FEEDBACK = COLOURS[5]
# Whose method is a request of which service of the action.
REQUESTS = (
    (ActionClient, "send_goal_async", "send_goal"),
    (ClientGoalHandle, "get_result_async", "get_result"),
    (ClientGoalHandle, "cancel_goal_async", "cancel_goal"),
)


@dataclass
class Request:
    """A request of an action client: to which service of the action, when it was sent, when its answer came.

    Seconds of the system's clock, as the client saw them; `answered` is nan while there is no answer.
    """

    service: str  # send_goal, get_result or cancel_goal
    sent: float
    answered: float = math.nan
    answer: Any = None
    uuid: bytes = b""  # of the goal; of a goal that was sent, once it is answered


@contextlib.contextmanager
def note_requests() -> Iterator[list[Request]]:
    """Note what the action clients of this process ask for while the block runs, and when the answers come."""
    noted: list[Request] = []
    plain = [(owner, name, getattr(owner, name)) for owner, name, _ in REQUESTS]
    for (owner, name, service), (_, _, method) in zip(REQUESTS, plain, strict=True):
        setattr(owner, name, _noting(method, service, noted))
    try:
        yield noted
    finally:
        for owner, name, method in plain:
            setattr(owner, name, method)


def _noting(method: Callable[..., Future], service: str, noted: list[Request]) -> Callable[..., Future]:
    def ask(asking: ActionClient | ClientGoalHandle, *args: Any, **kwargs: Any) -> Future:
        request = Request(service, time.time(), uuid=_uuid(asking))
        noted.append(request)

        def note(future: Future) -> None:
            request.answered, request.answer = time.time(), future.result()
            request.uuid = request.uuid or _uuid(request.answer)

        future = method(asking, *args, **kwargs)
        future.add_done_callback(note)
        return future

    return ask


def _uuid(of: Any) -> bytes:
    """The id of a goal handle's goal; nothing of anything else."""
    return bytes(bytearray(of.goal_id.uuid)) if isinstance(of, ClientGoalHandle) else b""


@dataclass(frozen=True)
class _Row:
    """One thing that was said."""

    time: float
    is_asked: bool  # by the client; else the server says it
    text: str
    colour: str = INK


@takes(title=TEXT | None)
def plot_conversation(recorded: Recording, requests: list[Request], title: str | None = None) -> Plot:
    """What client and server said to each other about a goal, the first one recorded: a row for each thing, in order.

    Takes a recording of an action's `_action/status` and `_action/feedback`, and what note_requests() gave. Requests
    and answers stand at the moment at which the client sent or got them, feedback and states at the moment at which
    they arrived at the recording. Raises ValueError for other topics and if no goal was active.
    """
    if not (isinstance(requests, list) and all(isinstance(one, Request) for one in requests)):
        raise TypeError("plot_conversation() takes what note_requests() gave as its second argument")
    action, goals = recorded_goals(recorded)
    goal = goals[0]
    rows = _rows(goal, requests)
    if not rows:
        raise ValueError(f"nothing was said about the first goal of {action} while it was recorded")
    start = rows[0].time
    plot = Plot(9.0, 1.3 + 0.27 * len(rows), title or f"A goal of {action}")
    axes = style(plot.subplots(), ylabel="time since the goal was sent [ms]")
    axes.grid(visible=False)
    for x, name in ((CLIENT, "client"), (SERVER, "server")):
        axes.axvline(x, color=FAINT, linewidth=1.0, linestyle="--", zorder=1)
        at: dict[str, Any] = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points"}
        axes.annotate(name, (x, 1.0), (0, 8), ha="center", color=INK, fontsize=10.5, fontweight="bold", **at)
    for number, row in enumerate(rows):
        _draw_row(axes, number, row)
    seen = _draw_states(axes, goal, [row.time for row in rows])
    axes.set_xlim(-0.12, 1.12)
    axes.set_ylim(len(rows) - 0.4, -0.9)
    axes.set_xticks([])
    axes.set_yticks(range(len(rows)), [f"{(row.time - start) * 1e3:.0f}" for row in rows])
    axes.spines["bottom"].set_visible(False)
    shades = [Patch(facecolor=c, edgecolor=FAINT, label=s) for s, c in OF_STATE.items() if s in seen]
    legend(axes, handles=shades, loc="center left", bbox_to_anchor=(1.0, 0.5), title="state of the goal")
    said = [f"{(row.time - start) * 1e3:.0f} ms {'client' if row.is_asked else 'server'}: {row.text}" for row in rows]
    states = [f"{state} after {(time - start) * 1e3:.0f} ms" for time, state in goal.changes]
    plot.description = f"A goal of {action}. {'; '.join(said)}. Its states: {', '.join(states)}."
    return plot


def _rows(goal: Goal, requests: list[Request]) -> list[_Row]:
    """What was said about the goal, in the order of its moments."""
    rows = [_Row(time, False, f"feedback {n}", FEEDBACK) for n, time in enumerate(goal.feedback, 1)]
    for request in (one for one in requests if one.uuid == goal.uuid):
        rows.append(_Row(request.sent, True, f"{request.service} request"))
        if not math.isnan(request.answered):
            words, colour = _answer(request)
            rows.append(_Row(request.answered, False, f"{request.service} response: {words}", colour))
    return sorted(rows, key=lambda row: row.time)


def _answer(request: Request) -> tuple[str, str]:
    match request.service:
        case "send_goal":
            return ("accepted" if request.answer.accepted else "rejected"), INK
        case "cancel_goal":
            return ("granted" if request.answer.goals_canceling else "refused"), OF_STATE["CANCELING"]
    state = STATES[request.answer.status]
    return state, OF_END.get(state, INK)


def _draw_row(axes: Axes, number: int, row: _Row) -> None:
    x, to = (CLIENT, SERVER) if row.is_asked else (SERVER, CLIENT)
    look = {"arrowstyle": "-|>", "color": row.colour, "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (to, number), (x, number), arrowprops=look, zorder=3)
    axes.annotate(
        row.text, (0.5, number), (0, 2), textcoords="offset points", ha="center", va="bottom", color=INK, fontsize=8.5
    )


def _draw_states(axes: Axes, goal: Goal, times: list[float]) -> set[str]:
    """The states of the goal as a bar on the server's line, between the rows in whose time they fell.

    Returns those that are long enough to be seen.
    """
    moments = [time for time, _ in goal.changes] + [times[-1]]
    places = np.interp(moments, times, np.arange(len(times)))
    seen = set()
    for (_, state), top, bottom in zip(goal.changes, places, places[1:], strict=False):
        if state in OF_STATE:
            look: dict[str, Any] = {"facecolor": OF_STATE[state], "edgecolor": FAINT, "linewidth": 0.8, "zorder": 2}
            axes.add_patch(Rectangle((SERVER - BAR / 2, top), BAR, bottom - top, **look))
            if bottom - top > SHORT:
                seen.add(state)
    return seen
