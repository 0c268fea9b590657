"""Answers to debugging-1: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

KEEPS = "\nstop()" + worked("debugging-1")

ANSWERS = Answers(
    "debugging-1",
    2,
    KEEPS,
    [
        Wrong("swapped", changed(KEEPS, ('"/speed_limit", "/scan"', '"/scan", "/speed_limit"')), 0, "Durability"),
        Wrong("half", changed(KEEPS, ('"/scan"', '"/map_scans"')), 1, "Reliability BEST_EFFORT"),
        Wrong("node", changed(KEEPS, ('"/speed_limit"', '"/map_server"')), 1, "Durability TRANSIENT_LOCAL"),
        Wrong("both", changed(KEEPS, ('"/speed_limit"', '["/speed_limit", "/scan"]')), 1, "You gave ["),
    ],
    {
        "no_slash": 'kept, lossy = "speed_limit", " scan"',
        "alone": 'import numpy as np\nkept, lossy = {"/speed_limit"}, np.array(["/scan"])',
        "hidden": changed(KEEPS, ('"/speed_limit"', '"/turtle1/rotate_absolute/_action/status"')),
    },
)
