"""The cause of an error in ROS's terms, and its cure, in one sentence: for boxes, checks and tracebacks alike."""

from __future__ import annotations

import contextlib

TYPE_CHECKING = False  # type checkers take it for True
if TYPE_CHECKING:
    from course_kit.ros.causes.raised import Rule


def _rules() -> tuple[Rule, ...]:
    """All rules; loaded when an error is to be explained, for whatever starts ROS could have one."""
    from course_kit.ros.causes import callbacks, interfaces, nodes, parameters, python_names, ros_names, transforms

    return (
        *nodes.RULES,
        *callbacks.RULES,
        *interfaces.RULES,
        *parameters.RULES,
        *transforms.RULES,
        *ros_names.RULES,
        *python_names.RULES,  # the least telling ones
    )


def cause_of(error: BaseException) -> str:
    """The cause and the cure of what was raised, in one sentence; '' where they are not known."""
    with contextlib.suppress(Exception):  # objects of a student's are looked at, which may raise whatever they like
        from course_kit.ros.causes.raised import Raised

        raised = Raised(error)
        for kinds, pattern, sentence in _rules():
            if (found := raised.fits(kinds, pattern)) is not None:
                told = found.expand(sentence) if isinstance(sentence, str) else sentence(raised, found)
                if told:
                    return told
    return ""


def cause_of_line(text: str) -> str:
    """The cause and the cure of what rclpy or tf2 logs, where it raises nothing."""
    from course_kit.ros.causes import callbacks, transforms

    logged = (*callbacks.LOGGED, *transforms.LOGGED)
    return next((sentence for beginning, sentence in logged if text.startswith(beginning)), "")


def with_cause(text: str, error: BaseException) -> str:
    """A text about an error, and what the cause is, if that is known."""
    return f"{text}\n    → {told}" if (told := cause_of(error)) else text
