"""Chapter 2's exercises: what each asks of packages, launches and types, and how it is checked."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from std_msgs.msg import String

from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import answer, expect, pause, require, wait
from course_kit.examining.vocabulary_services import expect_service
from course_kit.examining.vocabulary_topics import (
    expect_compatible_subscription,
    expect_subscription,
    expect_topic,
    listen,
    publisher,
    rate,
    values,
)
from course_kit.examining.vocabulary_workspace import (
    expect_definition,
    expect_executable,
    expect_gone,
    expect_installed,
    expect_nodes,
    expect_package,
    run_to_end,
    said,
    set_parameter,
    start,
)


@exercise("workspace-1", "A package of your own", points=2, level="warm-up", timeout=25, file="greeter/package.xml")
def greeter() -> None:
    """The package is built, and its program greets."""
    expect_package("greeter", "ament_python", points=1)
    expect_executable("greeter", "greet")
    greet = run_to_end("ros2", "run", "greeter", "greet", timeout=15.0)
    expect(
        "`ros2 run greeter greet` says `Hi from greeter.` and ends with status 0",
        greet.status == 0 and greet.says("Hi from greeter."),
        f"{said(greet)}`--node-name greet` makes a program that says so; a line that you add must not take its place.",
    )


@exercise("workspace-2", "Louder", points=3, level="medium", timeout=50, file="greeter/greeter/loud.py")
def loud() -> None:
    """It says in capitals what it hears, with a mark that can be changed, and ends well."""
    expect_package("greeter", "ament_python")
    expect_executable("greeter", "loud")
    first = start("ros2", "run", "greeter", "loud")
    expect_nodes(first, "/loud")
    expect_subscription("/chatter", String)
    expect_topic("/loud", String)
    heard = _say("good morning")
    expect(
        "it says in capitals what it hears, with `!` at the end",
        heard == "GOOD MORNING!",
        f"To `good morning` it said {heard!r}. {said(first) if heard is None else ''}"
        "Publish `message.data.upper()` and the value of the parameter `mark`.",
    )
    taken, why = set_parameter("/loud", "mark", "?!")
    heard = _say("and now")
    expect(
        "`mark` can be changed while it runs",
        taken and heard == "AND NOW?!",
        f"After `ros2 param set /loud mark ?!` it said {heard!r}. "
        + ("Read the parameter each time that you need it." if taken else f"It refused the value: {why}. Declare it."),
    )
    first.stop()
    wait(lambda: first.status is not None, 3.0)
    expect_gone("/loud")
    second = start("ros2", "run", "greeter", "loud", "--ros-args", "-p", "mark:=…")
    expect_nodes(second, "/loud")
    heard = _say("again")
    expect(
        "it takes `mark` from the command line, and ends with status 0 at Ctrl-C",
        heard == "AGAIN…" and first.status == 0,
        f"Started with `--ros-args -p mark:=…` it said {heard!r}, and Ctrl-C ended it with status {first.status}: "
        f"give `args` to rclpy.init or leave them out, and catch KeyboardInterrupt, as spin.py does.",
    )


def _say(words: str) -> str | None:
    """Say something on /chatter; what came on /loud, if anything did."""
    voice, answers = publisher("/chatter", String), listen("/loud", String)
    expect_compatible_subscription("/chatter", voice)
    wait(lambda: answers.publisher_count, 3.0, "the publisher of /loud")
    for _ in range(3):  # an answer is lost if the node has not found the listener yet
        voice.publish(String(data=words))
        if wait(lambda: len(answers), 1.5, "words on /loud"):
            break
    pause(0.1)
    return answers.last.data if len(answers) else None


@exercise("workspace-3", "Two rooms", points=3, level="medium", timeout=75, file="greeter/launch/rooms.launch.py")
def rooms() -> None:
    """A launch of two rooms with words of their own, and the attic hears the kitchen."""
    expect_package("greeter", "ament_python")
    expect_installed("greeter", "launch/rooms.launch.py")
    launch = start("ros2", "launch", "greeter", "rooms.launch.py", "kitchen_words:=Soup", "attic_words:=Dust")
    nodes = [f"/{room}/{name}" for room in ("kitchen", "attic") for name in ("talker", "loud")]
    expect_nodes(launch, *nodes, points=1)
    heard = {topic: listen(topic, String) for topic in ("/kitchen/chatter", "/attic/chatter", "/attic/loud")}
    wait(lambda: len(heard["/kitchen/chatter"]) and len(heard["/attic/chatter"]), 12.0, "words in both rooms")
    wait(lambda: len(heard["/attic/loud"]), 4.0, "the words of the attic's loud")
    said_here = {topic: _words(said_there) for topic, said_there in heard.items()}
    expect(
        "each room has the words of its argument",
        said_here["/kitchen/chatter"] == {"Soup"} and said_here["/attic/chatter"] == {"Dust"},
        f"With `kitchen_words:=Soup attic_words:=Dust` the talker of the kitchen said "
        f"{_listed(said_here['/kitchen/chatter'])}, that of the attic {_listed(said_here['/attic/chatter'])}: "
        "DeclareLaunchArgument, and "
        'parameters=[{"words": LaunchConfiguration(…)}]. `%ros2 topic list` shows where they talk.',
    )
    expect(
        "the attic's `loud` hears the kitchen",
        said_here["/attic/loud"] == {"SOUP"},
        f"On `/attic/loud` there was {_listed(said_here['/attic/loud'])}: its subscription `chatter` is to be remapped "
        f"to `/kitchen/chatter`, with a slash, or the name stays in the attic. `%ros2 node info /attic/loud` shows it.",
    )


def _words(heard: Heard) -> set[str]:
    """The words in front of the numbers."""
    return {text.split(":")[0] for text in values(heard, "data")}


def _listed(words: set[str]) -> str:
    return ", ".join(f"`{word}`" for word in sorted(words)) or "nothing"


@exercise(
    "workspace-4",
    "A battery",
    points=4,
    level="medium",
    timeout=30,
    node_class="Charger",
    file="robot_interfaces/package.xml",
    types=("robot_interfaces",),
)
def battery() -> None:
    """The definitions are as asked; the node publishes one and serves the other."""
    expect_package("robot_interfaces", "ament_cmake")
    right = expect_definition("robot_interfaces", "msg/Battery")
    right &= expect_definition("robot_interfaces", "srv/Recharge")
    if not right:
        require("the node can be looked at", False, "Only with these types: put them right, build, restart the kernel.")
    from robot_interfaces.msg import Battery  # the checker's own
    from robot_interfaces.srv import Recharge

    answer()
    expect_topic("/battery", Battery)
    client = expect_service("/recharge", Recharge)
    heard = listen("/battery", Battery)
    wait(lambda: len(heard) >= 4, 6.0, "four messages on /battery")
    left = values(heard, "percentage")
    expect(
        "`/battery` comes once a second, each time with less",
        len(left) >= 4 and abs(rate(heard) - 1.0) < 0.15 and all(after < before for before, after in pairwise(left)),
        f"It had {[round(one, 1) for one in left]} in 6 s: a timer with a period of 1.0 s, and less than before in "
        f"`percentage` each time.",
    )
    refused = client.ask(percentage=120.0).response
    accepted = client.ask(percentage=90.0).response
    count = len(heard)
    wait(lambda: len(heard) > count + 1, 4.0, "the next messages on /battery")
    then = values(heard, "percentage")[-1:]
    is_refused = refused is not None and not refused.accepted and refused.reason
    is_accepted = accepted is not None and accepted.accepted and then and 80.0 <= then[0] <= 90.0
    expect(
        "`/recharge` sets the percentage, and refuses more than 100",
        is_refused and is_accepted,
        f"To 120 % it answered {_shortly(refused)}, to 90 % {_shortly(accepted)}, and then the battery had "
        f"{then[0] if then else 'nothing'} %. What is refused has a reason, what is accepted has an effect.",
    )


def _shortly(response: Any) -> str:
    return f"accepted={response.accepted}, reason={response.reason!r}" if response is not None else "nothing"
