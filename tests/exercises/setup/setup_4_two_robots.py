"""Answers to setup-4: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

TWO = worked("setup-4")
ALL = '"/robot2/turtle1/cmd_vel", "/robot2/turtle1/pose", "/robot2/turtle1/color_sensor"'

# The first simulator comes when the checker has no topic of an earlier second one any more; a panel may have one.
ALONE = """from contextlib import suppress

with suppress(TimeoutError):
    wait_for(lambda: "/robot2/turtle1/pose" not in dict(turtlesim.get_topic_names_and_types()), timeout=3)
turtlesim = run(TurtleSim)
"""

# Asked of rclpy, which has the hidden ones too, at once; again and again, after a check that has seen the second one.
DIFFERENCE = """
stop()
turtlesim = run(TurtleSim)

def topics():
    return {name for name, types in turtlesim.get_topic_names_and_types()}

before = topics()
second = run(TurtleSim, namespace="/robot2")
new_topics = topics() - before
from geometry_msgs.msg import Twist
publisher = second.create_publisher(Twist, "turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = -3.0
publisher.publish(twist)
wait_for(lambda: second.world.turtles["turtle1"].x < 5.2, timeout=20)
"""

# Listed by the command, in a cell; the second in a process; the first is driven until it comes.
LISTED = """
from course_kit import start
from IPython.utils.capture import capture_output

stop()
turtlesim = run(TurtleSim)
with capture_output() as before:
    %ros2 topic list
first = drive()
first.press("up")
second = start("ros2 run turtlesim turtlesim_node --ros-args -r __ns:=/robot2")
first.press("up")
with record("/robot2/turtle1/pose", "turtlesim/msg/Pose") as seen:
    wait_for(lambda: seen.messages, timeout=20)
    with capture_output() as after:
        %ros2 topic list
    new_topics = sorted(set(after.stdout.split()) - set(before.stdout.split()))
    wait_for(lambda: turtlesim.world.turtles["turtle1"].forward == 0.0)
    panel = drive(namespace="robot2")
    panel.press("down")
    wait_for(lambda: seen.messages[-1].x < 5.2, timeout=20)
"""

# The second first, and it stays driven while the first is run anew; then it turns.
OTHER_ORDER = """
stop()
new_topics = tuple(f"/robot2/turtle1/{name}" for name in ("pose", "color_sensor", "cmd_vel"))
second = run(TurtleSim, namespace="robot2")
with record("/robot2/turtle1/pose") as seen:
    turtlesim = run(TurtleSim)
    first = drive()
    first.press("up")
    wait_for(lambda: turtlesim.world.turtles["turtle1"].x > 5.9, timeout=20)
    stop(turtlesim)
    turtlesim = run(TurtleSim)
    panel = drive(namespace="/robot2")
    panel.press("left")
    panel.press("up")
    wait_for(lambda: seen.messages and seen.messages[-1].x > 6.0)
"""

# The first one drove a moment before the second came, and rolls on.
ROLLS_ON = changed(
    TWO,
    (
        "second = run",
        """first = drive()
wait_for(lambda: first.teleop.count_subscribers("/turtle1/cmd_vel"))
first.press("up")
wait_for(lambda: turtlesim.world.turtles["turtle1"].forward)
second = run""",
    ),
)

# Both run already when the first one drives to the corners, as a student's do who goes back to setup-3.
FIRST_BEFORE = changed(
    TWO,
    (
        '    panel = drive(namespace="/robot2")\n',
        """    first = drive()
    wait_for(lambda: first.press("up") or turtlesim.world.turtles["turtle1"].x > 6.0)
    wait_for(lambda: turtlesim.world.turtles["turtle1"].forward == 0.0)
    panel = drive(namespace="/robot2")
""",
    ),
)

TELEPORTED = changed(
    TWO,
    (
        '    panel = drive(namespace="/robot2")\n    panel.press("up")\n',
        """    from turtlesim.srv import TeleportAbsolute
    panel = drive(namespace="/robot2")
    jump = panel.teleop.create_client(TeleportAbsolute, "turtle1/teleport_absolute")
    wait_for(jump.call_async(TeleportAbsolute.Request(x=9.0, y=5.0)))
""",
    ),
)

BOTH = changed(
    TWO,
    (
        '    panel.press("up")\n',
        """    other = drive()
    panel.press("up")
    wait_for(lambda: other.press("up") or turtlesim.world.turtles["turtle1"].x > 5.7)
""",
    ),
)

# What is driven where: the second listens to the first one's topic.
REMAPPED = """
stop()
turtlesim = run(TurtleSim)
rule = "turtle1/cmd_vel:=/turtle1/cmd_vel"
second = run(TurtleSim, namespace="/robot2", cli_args=["--ros-args", "-r", rule])
new_topics = {"/robot2/turtle1/pose", "/robot2/turtle1/color_sensor"}
panel = drive()
panel.press("up")
wait_for(lambda: second.world.turtles["turtle1"].x > 5.9, timeout=20)
"""

ANSWERS = Answers(
    "setup-4",
    4,
    TWO,
    [
        Wrong(
            "relative_names",
            changed(TWO, (ALL, '"turtle1/cmd_vel", "turtle1/pose", "turtle1/color_sensor"')),
            2,
            "with full names",
        ),
        Wrong(
            "one_lacks",
            changed(TWO, ('"/robot2/turtle1/pose", ', ""), ("second =", f"{ALONE}second =")),
            2,
            "with full names",
        ),
        Wrong("all_there_are", changed(TWO, (ALL, ALL + ', "/turtle1/pose", "/rosout"')), 2, "with full names"),
        Wrong(
            "first_driven",
            changed(
                TWO,
                ('drive(namespace="/robot2")', "drive()"),
                ('record("/robot2/turtle1/pose")', 'record("/turtle1/pose")'),
            ),
            3,
            "The second drove 0.0 m",
        ),
        Wrong(
            "no_second",
            'stop()\nturtlesim = run(TurtleSim)\nnew_topics = {"/robot2/turtle1/pose"}\n',
            0,
            "Start it with `run(TurtleSim",
        ),
        Wrong(
            "not_driven", changed(TWO, ('    panel.press("up")\n', ""), ("> 6.0", "> 5.0")), 3, "The second drove 0.0 m"
        ),
        Wrong("teleported", TELEPORTED, 3, "The second drove 0.0 m"),
        Wrong("both_driven", BOTH, 3, "the first moved"),
        Wrong("no_first", changed(TWO, ("turtlesim = run(TurtleSim)\n", "")), 3, "both are to run"),
        Wrong("remapped", REMAPPED, 1, "It has no /robot2/turtle1/cmd_vel"),
        Wrong(
            "driven_before",
            TWO + '\nsecond = run(TurtleSim, namespace="/robot2")\n',
            3,
            "The second drove 0.0 m since it was started",
        ),
        Wrong(
            "other_namespace",
            changed(
                TWO,
                ('(TurtleSim, namespace="/robot2")', '(TurtleSim, namespace="/robot_2")'),
                ('with record("/robot2/turtle1/pose")', 'with record("/turtle1/pose")'),
                ("> 6.0", "> 5.0"),
            ),
            2,
            "Did you mean",
        ),
    ],
    {
        "difference": DIFFERENCE,
        "difference_again": DIFFERENCE,
        "drives_on": changed(DIFFERENCE, ("x < 5.2", "x < 5.5")),  # the check comes when it has driven 5 cm
        "listed": LISTED,
        "other_order": OTHER_ORDER,
        "rolls_on": ROLLS_ON,
        "first_before": FIRST_BEFORE,
        "after_all": changed(DIFFERENCE, ("= topics() - before", "= (topics() - before) | {'/robot2/turtle1/pose'}")),
    },
)
