"""Notes about a hand-in: a line each, bounded, printable. Pure: no ROS."""

from __future__ import annotations

from course_kit.classroom.collect.handin_names import printable

MAX_NOTES = 30
NAMED = 3  # of the files of which the same is said


def size_text(size: int) -> str:
    """A size in words: 25.3 MB."""
    return f"{size / 1e6:,.1f} MB" if size >= 100_000 else f"{size:,} bytes"


class Notes:
    """Collects them; files of which the same is said share one."""

    def __init__(self) -> None:
        self._lines: dict[str, None] = {}
        self._said_of: dict[str, dict[str, None]] = {}  # names by what is said of them; dicts keep the order

    def add(self, line: str) -> None:
        """Tell this, once."""
        self._lines[line] = None

    def leave_out(self, name: str, why: str) -> None:
        """Tell that a file was left out; the reason follows a colon."""
        self.say_of(name, f"left out: {why}", past=True)

    def say_of(self, name: str, what: str, past: bool = False) -> None:
        """Tell that a file is this, or was."""
        self._said_of.setdefault(("was " if past else "is ") + what, {})[name] = None

    def lines(self) -> tuple[str, ...]:
        """All of them, of too many the first ones."""
        lines = [*self._lines, *(_sentence(list(names), what) for what, names in self._said_of.items())]
        shown = [printable(line, 500) for line in lines[:MAX_NOTES]]
        return (*shown, f"and {len(lines) - MAX_NOTES} notes more") if len(lines) > MAX_NOTES else tuple(shown)


def _sentence(names: list[str], what: str) -> str:
    """What is said of one file or of several; of many only the first ones are named."""
    shown = ", ".join(printable(name, 200 if len(names) == 1 else 100) for name in names[:NAMED])
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    verb, _, rest = what.partition(" ")
    return f"{shown}{more} {verb if len(names) == 1 else {'is': 'are', 'was': 'were'}[verb]} {rest}"
