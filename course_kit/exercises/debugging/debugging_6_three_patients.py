"""The check of debugging-6: three robots of the fault lab, each with a fault."""

from __future__ import annotations

from typing import Any

from course_kit.base.arguments import shown
from course_kit.exercises.checker.assertions import expect, parts
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.debugging.robot_well import expect_well
from course_kit.exercises.faults import all_faults

SEEDS = (9, 31, 17)


@check_of("debugging-6")
def three_patients(value: Any) -> None:
    """The causes of three faults, the last of which is repaired."""
    for seed, cause in zip(SEEDS, parts(value, len(SEEDS)), strict=True):
        fault = all_faults.pick(seed)
        known = cause in all_faults.FAULTS if isinstance(cause, str) else False
        expect(
            f"the cause of seed {seed}",
            cause == fault.id,
            f"You gave {shown(cause)}. "
            + (all_faults.find(cause).evidence if known else "It is an id, as `faults.catalogue()` lists them."),
        )
    expect_well(points=2)
