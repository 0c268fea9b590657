"""Causes of a NameError: a name that no cell has defined."""

from __future__ import annotations

import re

from course_kit.ros.causes.raised import Raised, Rule, nearest

AFTER_RESTART = "after a restart of the kernel, run the cells above first (menu Run, Run All Above Selected Cell)"


def _unknown(raised: Raised, found: re.Match[str]) -> str:
    meant = nearest(found[1], raised.names() - {found[1]})
    guess = f"did you mean {meant}? If not: " if meant else ""
    return f"No cell that has run in this kernel made {found[1]}: {guess}{AFTER_RESTART}"


RULES: tuple[Rule, ...] = (("NameError", r"name '(\w+)' is not defined", _unknown),)
