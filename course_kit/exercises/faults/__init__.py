"""The fault lab of chapter 6: `faults.start('qos')` starts a robot of four programs with a fault in it.

The faults are real ones of real programs, each a process of its own. What is asked of a robot that is well stands in
health.py, and is seen from outside, through the DomainObserver that the checker uses, too.
"""

from course_kit.exercises.faults.lab import (  # noqa: F401  (for who writes faults.start)
    answer,
    catalogue,
    hint,
    is_repaired,
    manual,
    process,
    solution,
    start,
    stop,
    symptom,
    terminal,
)
