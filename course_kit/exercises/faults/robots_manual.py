"""The robot's manual: what its four programs are, and what is there when all is well. Pure data."""

from __future__ import annotations

from course_kit.base.text import table
from course_kit.exercises.faults.fault import HEALTHY

ENDS = (
    ("program", "node", "takes", "gives"),
    ("simulator", "/turtlesim", "/turtle1/cmd_vel (Twist)", "/turtle1/pose, 62.5 Hz"),
    ("scanner", "/scanner", "/turtle1/pose", "/scan (LaserScan), 10 Hz"),
    ("map_server", "/map_server", "/scan", "/map_scans (Int32), 2 Hz"),
    ("", "", "", "/speed_limit (Float32), once"),
    ("", "", "", "service /get_map (GetMap)"),
    ("planner", "/planner", "/scan, /speed_limit, /get_map", "/turtle1/cmd_vel (Twist), 10 Hz"),
)
WELL = """\
A turtle on patrol: the scanner measures to the walls, the map server puts every scan into a
map and counts them on /map_scans, the planner drives ahead while there is room and turns
where there is none. Without a fresh scan, a fresh map and a speed limit it stands still, and
logs why."""
AGAIN = """\
Each runs as a process of its own. How they are started, and started again in place of one
that runs (under the program's name; without it, a second one would run beside the first):"""


def text() -> str:
    """The manual."""
    starts = [f'    start("{start.command}", name="{program}")' for program, start in HEALTHY.items()]
    return "\n".join([WELL, "", table(ENDS, left=4), "", AGAIN, "", *starts])
