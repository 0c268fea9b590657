"""The check of workspace-2: a node of a package that says louder what it hears."""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.publisher import Publisher
from std_msgs.msg import String

from course_kit.exercises.checker.assertions import chance, expect, pause, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.topic_assertions import (
    expect_compatible_subscription,
    expect_subscription,
    expect_topic,
    is_published,
    listen,
    publisher,
    values,
)
from course_kit.exercises.checker.workspace_assertions import (
    expect_executable,
    expect_gone,
    expect_nodes,
    expect_package,
    interrupt,
    said,
    set_parameter,
    start,
)
from course_kit.ros.observing.received_messages import ReceivedMessages

PHRASES = (
    "good morning", "Fresh Coffee", "mañana a las 7", "naïve café", "Привет, мир", "ώρα", "ünten links", "Robot no. 5",
    "x", "it Is LATE", "señor Ångström", "a b  c", "level 3 of 4", "déjà vu", "Живее, да", "to be, or not",
)  # fmt: skip
MARKS = (" ok", " she said", " (aha)", " och då", "~abc")  # with letters, which stay as they are
START_MARKS = ("oh…", "(oh)", "^o^", "¡aha", "_end")
ECHO_TIMEOUT = 4.0  # seconds; most is for a busy machine


@check_of("workspace-2")
def loud() -> None:
    """It says in capitals what it hears, with a mark that can be changed, and ends well."""
    expect_package("greeter", "ament_python")
    expect_executable("greeter", "loud")
    phrases = chance().sample(PHRASES, 12)
    first = start("ros2", "run", "greeter", "loud")
    expect_nodes(first, "/loud")
    expect_subscription("/chatter", String)
    expect_topic("/loud", String)
    ends = _ends()
    said_first = _with_odd_ones(phrases[:4])
    heard = _say(ends, said_first)
    expect(
        "it says in capitals what it hears, with `!` at the end",
        heard == _louder(said_first, "!"),
        f"{_described(said_first, heard)}{'' if heard else said(first)}"
        "Publish `message.data.upper()` and the value of the parameter `mark`, once for each message, whatever is in "
        "it: blanks, nothing, or the same again.",
    )
    marks = [chance().choice(MARKS), ""]
    chance().shuffle(marks)
    faults = [_fault_of(ends, mark, phrases[4 + 2 * place :][:2]) for place, mark in enumerate(marks)]
    expect("`mark` can be changed while it runs, also to nothing", not any(faults), next(filter(None, faults), ""))
    statuses = [interrupt(first)]
    expect_gone("/loud")
    mark = chance().choice(START_MARKS)
    second = start("ros2", "run", "greeter", "loud", "--ros-args", "-p", f"mark:={mark}")
    expect_nodes(second, "/loud")
    heard = _say(_ends(), phrases[8:])
    statuses.append(interrupt(second))
    hints = []
    if heard != _louder(phrases[8:], mark):
        why = _why_wrong(phrases[8:], mark, heard)
        hints.append(f"Started with `--ros-args -p mark:={mark}`: {_described(phrases[8:], heard)}{why}")
    if statuses != [0, 0]:
        ended = " and ".join("did not end it" if s is None else f"ended it with status {s}" for s in statuses)
        why = "give `args` to rclpy.init or leave them out, and catch KeyboardInterrupt, as spin.py does."
        hints.append(f"Ctrl-C {ended}: {why}")
    expect("it takes `mark` from the command line, and ends with status 0 at Ctrl-C", not hints, " ".join(hints))


def _with_odd_ones(phrases: Sequence[str]) -> list[str]:
    """Phrases, one of them twice in a row, one with blanks at both ends, and an empty one between them."""
    first, second, *others = phrases
    parts = [[first, first], [f"  {second} "], [""], others]
    chance().shuffle(parts)
    return [phrase for part in parts for phrase in part]


def _ends() -> tuple[Publisher, ReceivedMessages]:
    """Ends of /chatter and /loud that the node knows."""
    voice = publisher("/chatter", String)
    is_published("/loud")  # whose topics come later than its name cannot be met yet
    answers = listen("/loud", String)
    expect_compatible_subscription("/chatter", voice)
    return voice, answers


def _say(ends: tuple[Publisher, ReceivedMessages], phrases: Sequence[str]) -> list[str]:
    """Say phrases, each when the one before is answered; what came on /loud since, and just after."""
    voice, answers = ends
    before = len(answers)
    for phrase in phrases:
        count = len(answers)
        voice.publish(String(data=phrase))
        if not wait(lambda: len(answers) > count, ECHO_TIMEOUT, "words on /loud"):  # noqa: B023  (waits at once)
            break
    pause(0.3)
    return values(answers, "data")[before:]


def _fault_of(ends: tuple[Publisher, ReceivedMessages], mark: str, phrases: Sequence[str]) -> str:
    """What is wrong after this mark was set, if anything."""
    taken, why = set_parameter("/loud", "mark", mark)
    if not taken:
        return f"It refused `ros2 param set /loud mark '{mark}'`: {why}. Declare it."
    heard = _say(ends, phrases)
    if heard == _louder(phrases, mark):
        return ""
    return f"After `ros2 param set /loud mark '{mark}'`: {_described(phrases, heard)}{_why_wrong(phrases, mark, heard)}"


def _why_wrong(phrases: Sequence[str], mark: str, heard: Sequence[str]) -> str:
    """What to do about words that are not those that should come with this mark."""
    if len(heard) != len(phrases):
        return "One message for each that comes, and no other."
    if heard == [(phrase + mark).upper() for phrase in phrases]:
        return "Only the words come in capitals, the mark as it is."
    if mark in START_MARKS and heard == _louder(phrases, "!"):
        return "Declare the parameter, and give `args` to rclpy.init or leave them out."
    if not mark and heard == _louder(phrases, "!"):
        return "An empty text is a mark too, for `or` it is none. Read the parameter each time that you need it."
    ends = [
        text.endswith(mark) if mark else text.lower().endswith(p[-1:].lower())
        for p, text in zip(phrases, heard, strict=True)
    ]
    if all(ends):
        return "The mark is right, the words are not: `message.data.upper()`, in which é becomes É."
    return "Read the parameter each time that you need it."


def _louder(phrases: Sequence[str], mark: str) -> list[str]:
    return [phrase.upper() + mark for phrase in phrases]


def _described(phrases: Sequence[str], heard: Sequence[str]) -> str:
    if len(heard) > len(phrases):
        return f"To {len(phrases)} messages, {_quoted(phrases)}, it said {len(heard)}: {_quoted(heard)}. "
    return f"To {_quoted(phrases[: len(heard) + 1])} it said {_quoted(heard) or 'nothing'}. "


def _quoted(words: Sequence[str]) -> str:
    return ", ".join(repr(word) for word in words)
