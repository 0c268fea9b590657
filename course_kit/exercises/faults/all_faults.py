"""All faults of the lab, by id. Pure data."""

from __future__ import annotations

import difflib

from course_kit.exercises.faults import callbacks, connections, starting
from course_kit.exercises.faults.fault import Fault

FAULTS: dict[str, Fault] = {fault.id: fault for fault in (*connections.FAULTS, *callbacks.FAULTS, *starting.FAULTS)}

# What each seed means, for good: texts, exercises and their answers name seeds. A new fault gets a seed at the end.
SEEDS = """
    no_server deadlock conda duplicate duplicate slow_callback service_name name duplicate not_sourced
    service_name not_sourced qos first_message dead domain namespace queue discovery type
    type discovery deadlock logging no_server no_server domain timer dead remapping
    remapping clock crash service_name queue remapping name type timer domain
    not_sourced no_server timer conda no_spin first_message crash namespace remapping crash
    qos duplicate first_message slow_callback deadlock crash remapping conda service_name duplicate
    logging qos service_name not_sourced qos no_spin crash crash not_sourced type
    dead name crash first_message slow_callback not_sourced namespace first_message domain deadlock
    first_message queue deadlock qos logging domain clock deadlock no_server crash
    domain crash no_spin qos remapping remapping namespace domain namespace no_server
""".split()  # noqa: SIM905  (a list of these would be a page)


def find(name: str) -> Fault:
    """The fault of that id. ValueError if there is none, with what may have been meant."""
    if isinstance(name, str) and name in FAULTS:
        return FAULTS[name]
    near = difflib.get_close_matches(str(name), FAULTS, n=1)
    hint = f"Did you mean {near[0]!r}?" if near else f"There are {', '.join(sorted(FAULTS))}."
    raise ValueError(f"there is no fault {name!r}. {hint}")


def pick(seed: int) -> Fault:
    """The fault that a seed means; seeds beyond the table begin again at its front. TypeError for no whole number."""
    if not isinstance(seed, int):
        raise TypeError(f"a seed is a whole number, such as seed=1, not {seed!r}")
    return FAULTS[SEEDS[seed % len(SEEDS)]]


def options(fault: Fault) -> list[Fault]:
    """What a student chooses the cause from: the true one and those that look alike, sorted by id."""
    return sorted((fault, *map(find, fault.alike)), key=lambda option: option.id)
