"""How an answer differs from the solution, told in words where they can be had, else line by line."""

from __future__ import annotations

import pytest
from rclpy.qos import qos_profile_sensor_data

from course_kit.exercises.solutions import differences
from course_kit.exercises.solutions.ros_calls import RosCalls
from tests.exercises.chapter import answers_to, changed, solved

SOLUTIONS = {name: solved(name).code for name in ("topics-1", "topics-2", "services-2", "services-3", "services-4")}
SOLUTIONS |= {name: solved(name).code for name in ("actions-2", "topics-3")}


def told(name: str, *changes: tuple[str, str]) -> list[str]:
    return differences.of_classes(changed(SOLUTIONS[name], *changes), SOLUTIONS[name])


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("topics-1", ('"countdown")', '"counter")'), "Your node is called `counter`, the solution's `countdown`."),
        (
            "topics-1",
            ('"countdown", 10', '"count", 10'),
            "Your publisher is for `count`, the solution's for `countdown`.",
        ),
        (
            "topics-1",
            ("(Int32, ", "(String, "),
            "Your publisher for `countdown` has the type `String`, the solution's `Int32`.",
        ),
        ("topics-1", ("timer(0.2", "timer(0.5"), "Your timer has a period of 0.5 s, the solution's of 0.2 s."),
        (
            "topics-1",
            ("self.publisher.get_subscription_count() == 0", "False"),
            "Yours has no `get_subscription_count`.",
        ),
        (
            "topics-2",
            ("qos_profile_sensor_data)", "10)"),
            "Your subscription for `scan` is RELIABLE, the solution's BEST_EFFORT.",
        ),
        (
            "services-2",
            ("self.client.wait_for_service(timeout_sec=timeout)", "True"),
            "Yours has no `wait_for_service`",
        ),
        (
            "services-3",
            (", callback_group=ReentrantCallbackGroup()", ""),
            "Your client for `add_two_ints` is in the node's own callback group, the solution's in a "
            "ReentrantCallbackGroup.",
        ),
        ("services-4", (", callback_group=group", ""), "is in the node's own callback group"),
        ("actions-2", ("cancel_callback=lambda goal: CancelResponse.ACCEPT,", ""), "Yours has no `cancel_callback`"),
        ("topics-3", ("self.create_publisher(Pose", "print(Pose"), "Yours has no publisher for `turtle1/pose_slow`."),
    ],
)
def test_what_differs_with_ros_is_told_in_words(name: str, change: tuple[str, str], words: str) -> None:
    sentences = told(name, change)
    assert any(sentence.startswith(words) or words in sentence for sentence in sentences), sentences
    assert not any("```" in sentence for sentence in sentences)


def test_a_coroutine_is_told_from_a_function() -> None:
    plain = SOLUTIONS["services-3"].replace("async ", "").replace("await ", "")
    words = differences.of_classes(plain, SOLUTIONS["services-3"])
    assert words == ["The solution has coroutines (`async def`), yours has none."]


@pytest.mark.parametrize(
    ("qos", "policies"),
    [
        ("5", ("RELIABLE", "VOLATILE")),
        ("qos_profile_sensor_data", ("BEST_EFFORT", "VOLATILE")),
        ("rclpy.qos.qos_profile_sensor_data", ("BEST_EFFORT", "VOLATILE")),
        ("mine", ("BEST_EFFORT", "VOLATILE")),
        ("QoSProfile(depth=1)", ("RELIABLE", "VOLATILE")),
        (
            "QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=R.BEST_EFFORT)",
            ("BEST_EFFORT", "TRANSIENT_LOCAL"),
        ),
        ("chosen()", ()),
        ("local", ("RELIABLE", "TRANSIENT_LOCAL")),
        ("qos_profile=7", ("RELIABLE", "VOLATILE")),
    ],
)
def test_a_qos_is_read_from_what_stands_there(qos: str, policies: tuple[str, ...]) -> None:
    source = (
        "class A(Node):\n    def __init__(self):\n"
        "        local = QoSProfile(depth=1, durability=D.TRANSIENT_LOCAL)\n"
        f"        self.create_publisher(Int32, '/a', {qos})"
    )
    (endpoint,) = RosCalls(source, {"mine": qos_profile_sensor_data}).endpoints
    assert (endpoint.kind, endpoint.name, endpoint.type, endpoint.qos) == ("publisher", "a", "Int32", policies)


def test_what_has_no_ros_in_it_is_compared_line_by_line() -> None:
    (block,) = told("topics-3", ("% 10 == 0", "% 9 == 0"))
    assert block.startswith("```diff\n--- yours\n+++ the solution\n")
    assert "-        if self.count % 9 == 0:\n+        if self.count % 10 == 0:" in block


def test_remarks_docstrings_and_layout_are_no_difference() -> None:
    assert told("topics-3", ("    def on_pose", "    # Now\n    def on_pose"), ("\n\n", "\n")) == []
    assert told("topics-3", ("(Node):", '(Node):\n    """Mine."""\n')) == []


def test_the_stamp_of_a_message_is_nothing_of_rclpy() -> None:
    assert not RosCalls("class A:\n    def f(self, pose):\n        return pose.header.stamp").uses


def test_another_way_is_not_compared_line_by_line() -> None:
    other = "class Relay:\n" + "".join(f"    x{number} = {number}\n" for number in range(30))
    assert differences.of_texts(other, SOLUTIONS["topics-3"]) == [
        "Yours goes another way, so no comparison line by line is shown."
    ]


def test_files_with_a_class_are_compared_as_classes_and_others_as_texts() -> None:
    files = solved("workspace-5").files
    patrol, yaml = files["ros2_ws/src/patrol/patrol/patrol.py"], files["ros2_ws/src/patrol/config/one.yaml"]
    assert differences.of_files(patrol.replace("import math\n", ""), patrol) == []
    assert differences.of_files(changed(patrol, ('"turtle1/pose"', '"pose"')), patrol) == [
        "Your subscription is for `pose`, the solution's for `turtle1/pose`."
    ]
    (block,) = differences.of_files(changed(yaml, ("side: 1.0", "side: 9.0")), yaml)
    assert "-    side: 9.0\n+    side: 1.0" in block
    assert differences.of_files(yaml + "\n\n", yaml) == []


@pytest.mark.parametrize("chapter", ["topics", "services", "actions", "debugging", "robot"])
def test_right_answers_in_other_styles_can_all_be_compared(chapter: str) -> None:
    for answers in answers_to(chapter):
        for style in answers.right.values():
            assert all(isinstance(each, str) and each for each in differences.of_classes(style, answers.reference))
