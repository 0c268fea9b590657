"""The check of workspace-3: a launch file with two namespaces."""

from __future__ import annotations

from std_msgs.msg import String

from course_kit.exercises.checker.assertions import chance, expect, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.topic_assertions import listen, values
from course_kit.exercises.checker.workspace_assertions import expect_installed, expect_nodes, expect_package, start
from course_kit.ros.observing.received_messages import ReceivedMessages
from course_kit.ros.subscriptions.topics import node_name

ROOM_WORDS = (
    "Soup", "Toast", "Salad", "Pasta", "Lemon", "Bread", "Dust", "Boxes", "Moths", "Ghosts", "Books", "Trunks",
)  # fmt: skip


@check_of("workspace-3")
def rooms() -> None:
    """A launch of two rooms with words of their own; the kitchen's talker is heard in both, the attic's in none."""
    expect_package("greeter", "ament_python")
    expect_installed("greeter", "launch/rooms.launch.py")
    words = dict(zip(("kitchen", "attic"), chance().sample(ROOM_WORDS, 2), strict=True))
    arguments = [f"{room}_words:={said_there}" for room, said_there in words.items()]
    chance().shuffle(arguments)
    launch = start("ros2", "launch", "greeter", "rooms.launch.py", *arguments)
    nodes = [f"/{room}/{name}" for room in words for name in ("talker", "loud")]
    expect_nodes(launch, *nodes, points=1)
    talkers, louds = ([listen(f"/{room}/{topic}", String) for room in words] for topic in ("chatter", "loud"))
    wait(lambda: all(len(heard) >= 4 for heard in talkers), 12.0, "words in both rooms")
    wait(lambda: all(len(heard) >= 4 for heard in louds), 4.0, "the words of both louds")
    kitchen, attic = map(_words, talkers)
    expect(
        "each room has the words of its argument",
        kitchen == {words["kitchen"]} and attic == {words["attic"]},
        f"With `{' '.join(arguments)}` the talker of the kitchen said {_listed(kitchen)}, that of the attic "
        f'{_listed(attic)}: DeclareLaunchArgument, and parameters=[{{"words": LaunchConfiguration(…)}}]. '
        f"`%ros2 topic list` shows where they talk.",
    )
    in_kitchen, in_attic = map(_words, louds)
    at_attics = {node_name(end) for end in current().test_domain.subscriptions("/attic/chatter")}
    expect(
        "both `loud` hear the kitchen, and only the kitchen",
        in_kitchen == in_attic == {said_there.upper() for said_there in kitchen} and not at_attics & set(nodes),
        f"The kitchen says {_listed(kitchen)}. On `/kitchen/loud` there was {_listed(in_kitchen)}, on "
        f"`/attic/loud` {_listed(in_attic)}: the subscription `chatter` of the attic's, and only of that, is to be "
        f"remapped to `/kitchen/chatter`, with a slash, or the name stays in the attic. `%ros2 node info /attic/loud` "
        f"shows it.",
    )


def _words(heard: ReceivedMessages) -> set[str]:
    """The words in front of the numbers."""
    return {text.split(":")[0] for text in values(heard, "data")}


def _listed(words: set[str]) -> str:
    return ", ".join(f"`{word}`" for word in sorted(words)) or "nothing"
