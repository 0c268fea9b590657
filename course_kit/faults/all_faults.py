"""All faults of the lab, by id. Pure data."""

from __future__ import annotations

import difflib
import random

from course_kit.faults import callbacks, connections, starting
from course_kit.faults.fault import Fault

FAULTS: dict[str, Fault] = {one.id: one for one in (*connections.FAULTS, *callbacks.FAULTS, *starting.FAULTS)}


def find(name: str) -> Fault:
    """The fault of that id. ValueError if there is none, with what may have been meant."""
    if isinstance(name, str) and name in FAULTS:
        return FAULTS[name]
    near = difflib.get_close_matches(str(name), FAULTS, n=1)
    hint = f"Did you mean {near[0]!r}?" if near else f"There are {', '.join(sorted(FAULTS))}."
    raise ValueError(f"there is no fault {name!r}. {hint}")


def pick(seed: int) -> Fault:
    """A fault by chance; the same one for the same seed."""
    return FAULTS[random.Random(seed).choice(sorted(FAULTS))]


def options(fault: Fault) -> list[Fault]:
    """What a student chooses the cause from: the true one and those that look alike, sorted by id."""
    return sorted((fault, *map(find, fault.alike)), key=lambda one: one.id)
