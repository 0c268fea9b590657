"""The chapters and exercises of the course: their titles, points and levels, and how to know that one was begun.

The folder of a chapter has the rest: the check of each exercise, and its worked solution. Pure: no ROS.
"""

from __future__ import annotations

import difflib

from course_kit.base.arguments import shown
from course_kit.exercises.exercise import Exercise

# In the order of the course: {the name of the chapter's folder, with which its exercises begin: its title}.
CHAPTERS = {
    "setup": "1 · Setup checks",
    "workspace": "2 · Workspace",
    "topics": "3 · Topics",
    "services": "4 · Services",
    "actions": "5 · Actions",
    "debugging": "6 · Debugging",
    "robot": "7 · A robot that finds its way",
}

EXERCISES = (
    Exercise("setup-1", "Read the report", points=1, level="warm-up", timeout=5, value=True),
    Exercise("setup-2", "A node of your own", points=2, level="warm-up", timeout=8, node_class="Greeter"),
    Exercise("setup-3", "Visit the corners", points=3, level="medium", timeout=12, node="/turtlesim"),
    Exercise("setup-4", "Two robots", points=4, level="harder", timeout=12, node="/robot2/turtlesim", value=True),
    Exercise("workspace-1", "A package of your own", points=2, level="warm-up", timeout=30, file="greeter/package.xml"),
    Exercise("workspace-2", "Louder", points=3, level="medium", timeout=60, file="greeter/greeter/loud.py"),
    Exercise("workspace-3", "Two rooms", points=3, level="medium", timeout=75, file="greeter/launch/rooms.launch.py"),
    Exercise(
        "workspace-4",
        "A battery",
        points=4,
        level="medium",
        timeout=40,
        node_class="Charger",
        file="robot_interfaces/package.xml",
        types=("robot_interfaces",),
    ),
    Exercise("workspace-5", "A patrol", points=5, level="project", timeout=150, file="patrol/package.xml"),
    Exercise("topics-1", "Count down", points=2, level="warm-up", timeout=35, node_class="Countdown"),
    Exercise("topics-2", "Why does nothing arrive?", points=2, level="medium", timeout=35, node_class="ScanCounter"),
    Exercise("topics-3", "A relay", points=3, level="medium", timeout=40, node_class="Relay"),
    Exercise("topics-4", "A figure of eight", points=5, level="project", timeout=150, node_class="FigureEight"),
    Exercise("services-1", "A lamp", points=2, level="warm-up", node_class="Lamp"),
    Exercise("services-2", "A client that never hangs", points=2, level="medium", timeout=45, node_class="SafeClient"),
    Exercise("services-3", "Ask while you are asked", points=3, level="medium", timeout=25, node_class="AddThreeTimes"),
    Exercise(
        "services-4", "Three at a time", points=3, level="medium", timeout=25, node_class="ParallelServer", node=""
    ),
    Exercise("services-5", "Draw on demand", points=5, level="project", timeout=145, node_class="StarPainter"),
    Exercise("actions-1", "Face west", points=2, level="warm-up", timeout=25, node_class="FaceWest"),
    Exercise("actions-2", "Count down", points=3, level="medium", timeout=40, node_class="CountdownServer"),
    Exercise("actions-3", "Impatience", points=3, level="medium", timeout=40, node_class="Impatient"),
    Exercise("actions-4", "No longer than that", points=3, level="medium", timeout=50, node_class="DeadlineServer"),
    Exercise(
        "actions-5",
        "A star, and back home",
        points=5,
        level="project",
        timeout=145,
        node_class="StarServer",
        types=("my_interfaces",),
    ),
    Exercise("debugging-1", "Who keeps, who loses", points=2, level="warm-up", timeout=5, value=True),
    Exercise("debugging-2", "Not so loud", points=3, level="medium", timeout=45, node_class="Quiet"),
    Exercise("debugging-3", "A watchdog", points=3, level="medium", timeout=30, node_class="Watchdog"),
    Exercise("debugging-4", "A bag of a circle", points=2, level="medium", timeout=20, value=True),
    Exercise(
        "debugging-5", "A distance that survives a teleport", points=3, level="harder", timeout=30, node_class="Mileage"
    ),
    Exercise("debugging-6", "Three patients", points=5, level="harder", timeout=60, value=True),
    Exercise("debugging-7", "A monitor", points=5, level="project", timeout=45, node_class="Monitor"),
    Exercise("robot-1", "Ahead of the robot", points=2, level="warm-up", timeout=100, node_class="AheadOfRobot"),
    Exercise("robot-2", "A wall that stays", points=3, level="medium", timeout=75, node_class="NearestWall"),
    Exercise("robot-3", "Cells of a beam", points=3, level="medium", timeout=60, function="cells_of_beam"),
    Exercise("robot-4", "A map", points=4, level="harder", timeout=120, node_class="MapMaker"),
    Exercise("robot-5", "map → odom", points=4, level="harder", timeout=40, node_class="MapToOdom"),
    Exercise("robot-6", "Resample", points=4, level="harder", timeout=45, node_class="Resampler"),
    Exercise("robot-7", "A path", points=4, level="harder", timeout=80, node_class="PathFinder"),
    Exercise("robot-8", "Drive there", points=5, level="project", timeout=240, node_class="DriveThere"),
    Exercise(
        "robot-9", "Rooms never seen", points=6, level="project", timeout=280, file="explorer/launch/explorer.launch.py"
    ),
)


def of_chapter(chapter: str) -> list[Exercise]:
    """Return the exercises of a chapter, in order."""
    return [exercise for exercise in EXERCISES if exercise.chapter == chapter]


def find(name: str) -> Exercise:
    """Return the exercise of that name. ValueError if there is none, with the name that may have been meant."""
    chapter = name.rsplit("-", 1)[0]
    there = {exercise.name: exercise for exercise in (of_chapter(chapter) or EXERCISES)}
    if name in there:
        return there[name]
    near = difflib.get_close_matches(name, there, n=1)
    hint = f"Did you mean {near[0]!r}?" if near else f"There are {', '.join(there)}."
    raise ValueError(f"there is no exercise {shown(name)}. {hint}")
