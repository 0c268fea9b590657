"""The options that say how much of a message is shown, for the verbs that print messages."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from course_kit.cli.ros2.verbs import all_of, argument, flag, number

if TYPE_CHECKING:
    from course_kit.cli.ros2.messages.yaml_text import Shown

TRUNCATE_LENGTH = 128

SHOWN = all_of(
    flag("--full-length -f", "print long arrays and strings in full"),
    argument(
        "--truncate-length -l",
        f"the number of elements or characters before '...' (default: {TRUNCATE_LENGTH})",
        type=number(int, lambda value: value >= 0, "value must be non-negative integer"),
        default=TRUNCATE_LENGTH,
    ),
    flag("--no-arr", "print only type and length of arrays"),
    flag("--no-str", "print only the length of strings"),
    flag("--flow-style", "print arrays in brackets, on one line"),
)


def shown(args: Namespace) -> Shown:
    """What the options ask for."""
    from course_kit.cli.ros2.messages.yaml_text import Shown

    return Shown(None if args.full_length else args.truncate_length, args.no_arr, args.no_str)
