"""The check of setup-2: a first node that greets in its log."""

from __future__ import annotations

import re

from rcl_interfaces.msg import Log

from course_kit.exercises.checker.assertions import expect
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.student_assertions import expect_running_node, logged_by

INFO = 20
GREETING = "Nice to meet you, "
NEARLY = "nice.{0,3}to.{0,3}meet"
GREETING_TIMEOUT = 3.0  # seconds; the text says 2
# What stands in place of a name: the text's own words, a variable that was not filled in, nothing.
NO_NAMES = {"", "yourname", "yournamehere", "myname", "name", "none"}


@check_of("setup-2", watches={"/rosout": Log})
def greeter() -> None:
    """A node /greeter runs and has logged a greeting with a name in it, at the level INFO."""
    expect_running_node("/greeter", "Greeter", points=1)
    lines = logged_by("greeter", lambda line: line.level == INFO and _greets(line.msg), GREETING_TIMEOUT)
    greetings = [line for line in lines if _greets(line.msg)]
    nearest = next((line for line in reversed(lines) if re.search(NEARLY, line.msg, re.IGNORECASE)), None)
    line = nearest or (lines[-1] if lines else None)
    heard = f"It logged {line.msg!r}." if line else "It logged nothing that the checker heard."
    hint = f"{heard} Log with `self.get_logger().info(…)` in __init__ (print() goes to nobody else), then run it again."
    if line and (nearest or any(one.level == INFO for one in lines)):
        hint = f"{heard} The line is exactly `{GREETING}` and then a name: {_what_is_wrong(line.msg)}"
    if greetings:
        hint = "The text is right, the level is not INFO: INFO is `self.get_logger().info(…)`."
    expect(f"it logged `{GREETING}…` with the level INFO", any(line.level == INFO for line in greetings), hint)


def _what_is_wrong(text: str) -> str:
    """What keeps a line from being a greeting, as far as that is seen."""
    if re.search(r"\byou\s+[^\W_]", text):
        return "the comma behind `you` is missing."
    if found := re.search(r"\{.*?\}|%s", text):
        return f"yours, not a placeholder for it. Put an f before the quotes, so that Python fills in `{found[0]}`."
    if found := re.search(r"<[^<>]*>|your name", text, re.IGNORECASE):
        return f"yours, not a placeholder for it. Write your own name where `{found[0]}` stands, without < and >."
    return "yours, not a placeholder for it; it comes within two seconds."


def _greets(text: str) -> bool:
    """Return True if a line greets with a name."""
    words = text.strip()
    if not words.startswith(GREETING) or re.search(r"[{}]|<[^<>]*>|%s|your name", words, re.IGNORECASE):
        return False
    return re.sub(r"[\W_]", "", words[len(GREETING) :]).casefold() not in NO_NAMES
