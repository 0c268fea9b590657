"""`ros2 topic echo` and `pub`: what they print and what arrives, between processes."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
import rclpy
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSPresetProfiles, ReliabilityPolicy

from course_kit.cli.ros2.command import run
from course_kit.cli.ros2.messages.yaml_text import Shown
from course_kit.cli.ros2.topic import endpoints
from course_kit.cli.ros2.topic.echo_text import expression, lost_text, message_text, selector
from course_kit.cli.ros2.verbs import CommandError, did_you_mean
from course_kit.ros.subscriptions import observer_node
from tests.ros2_command import program, ros2
from tests.ros2_running import Running
from tests.waiting import wait_until

pytestmark = pytest.mark.by_turns("many nodes and programs")

INTERRUPTED = 2
INVALID = "The passed message type is invalid\n"
TEN = "invalid literal for int() with base 10: 'ten'"
TWIST = "geometry_msgs.msg.Twist(linear=geometry_msgs.msg.Vector3(x={}, y=0.0, z=0.0), angular={})"
STILL = "geometry_msgs.msg.Vector3(x=0.0, y=0.0, z=0.0)"


@pytest.fixture(scope="module", autouse=True)
def world() -> Iterator[None]:
    with program("tests.ros2_transcripts.world"), program("tests.ros2_servers"):
        yield


# echo ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "printed"),
    [
        (("--field", "ranges"), "array('f', [1.0, 2.0, 3.0, 4.0, 5.0])\n---\n"),
        (("--field", "ranges[-1]"), "5.0\n---\n"),
        (("--field", "ranges.[-1]"), "5.0\n---\n"),
        (("--field", "header.frame_id"), "laser\n---\n"),
        (("--field", "header.stamp", "--flow-style"), "sec: 0\nnanosec: 0\n---\n"),
        (("--field", "header", "--no-str"), "stamp:\n  sec: 0\n  nanosec: 0\nframe_id: '<string length: <5>>'\n---\n"),
        (("--csv", "-l", "2"), "0,0,la...,-1.0,1.0,0.5,0.0,0.0,0.10000000149011612,10.0,1.0,2.0,...,\n"),
        (("--field", "header", "--filter", "m.frame_id == 'laser'", "--csv"), "0,0,laser\n"),
    ],
)
def test_echo_prints_what_is_asked_for(options, printed):
    outcome = ros2("topic", "echo", "/robot1/scan", "--once", *options)
    assert (outcome.out, outcome.err, outcome.status) == (printed, "", 0)


@pytest.mark.parametrize(
    ("words", "out", "err"),
    [
        (("/robot1/scan", "--field", "nope"), "", "Invalid field 'nope': 'LaserScan' object has no attribute 'nope'\n"),
        (("/robot1/scan", "--field", "ranges[9]"), "", "Invalid field 'ranges[9]': array index out of range\n"),
        (("/robot1/scan", "--field", "."), "", "Invalid field value '.'\n"),
        (("/chatter", "--filter", "m.("), "", "Invalid filter expression 'm.(': invalid syntax\n"),
        (
            ("/chatter", "--filter", "m.dat == 1"),
            "",
            "Invalid filter expression 'm.dat == 1': 'String' object has no attribute 'dat'\n",
        ),
        (("/chatter", "std_msgs/msg/Strin"), "", f"{INVALID}Did you mean std_msgs/msg/String?\n"),
        (("/chatter", "nope/msg/Nope"), "", INVALID),
        (("/chatter", "--qos-profile", "unknown", "--qos-depth", "1"), "", None),
        (
            ("/robot1/scam",),
            "WARNING: topic [/robot1/scam] does not appear to be published yet\n",
            "Could not determine the type for the passed topic\nDid you mean /robot1/scan?\n",
        ),
        (("/a b",), "", None),
    ],
)  # fmt: skip
def test_what_echo_cannot_do_is_said_in_a_line(words, out, err):
    outcome = ros2("topic", "echo", *words)
    assert (outcome.out, outcome.status) == (out, 1)
    assert outcome.err == err if err is not None else outcome.err.count("\n") == 1


def test_echo_goes_on_until_it_is_interrupted():
    with Running("topic", "echo", "/chatter") as echo:
        echo.until("---\n", count=3)
        echo.interrupt()
        outcome = echo.end()
    assert outcome.status == INTERRUPTED
    assert outcome.err == ""
    numbers = [int(n) for n in re.findall(r"data: 'Hello ROS2: (\d+)'\n---\n", outcome.out)]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert re.fullmatch(r"(data: 'Hello ROS2: \d+'\n---\n)+", outcome.out)


@pytest.mark.parametrize("limit", ["--timeout", "--duration"])
def test_echo_ends_well_after_a_time(limit):
    outcome = ros2("topic", "echo", "/chatter", limit, "5")
    assert (outcome.err, outcome.status) == ("", 0)
    assert outcome.out.count("---\n") >= 2
    nothing = ros2("topic", "echo", "/robot1/cmd_vel", limit, "0.2")
    assert (nothing.out, nothing.err, nothing.status) == ("", "", 0)


def test_the_information_about_a_message_comes_before_it():
    out = ros2("topic", "echo", "/chatter", "--once", "-i").out
    number = r"(\d+|null)"
    assert re.fullmatch(
        rf"publication_sequence_number: {number}\nreceived_timestamp: \d{{19}}\n"
        rf"reception_sequence_number: {number}\nsource_timestamp: \d{{19}}\n---\ndata: 'Hello ROS2: \d+'\n---\n",
        out,
    )


def test_raw_echo_prints_bytes():
    out = ros2("topic", "echo", "/chatter", "--once", "--raw").out
    assert re.fullmatch(r"b'\\x00\\x01\\x00\\x00.*Hello ROS2: \d+(\\x00)+'\n---\n", out)


def test_octets_are_printed_as_characters():
    out = ros2("topic", "echo", "/octets", "--once").out
    assert out == 'layout:\n  dim: []\n  data_offset: 0\ndata:\n- "\\0"\n- a\n- ÿ\n---\n'


def test_echo_follows_the_publishers_unless_told_otherwise():
    latched = ros2("topic", "echo", "/latched", "--timeout", "3")
    assert latched.out == "".join(f"data: {text}\n---\n" for text in ("one", "two", "three"))
    assert ros2("topic", "echo", "/latched", "--qos-durability", "volatile", "--timeout", "1").out == ""
    wanted = ("--qos-durability", "transient_local", "--qos-reliability", "reliable")
    last = ros2("topic", "echo", "/latched", *wanted, "--once")
    assert last.out == "data: one\n---\n"


def test_a_qos_that_fits_no_publisher_is_warned_of():
    with Running("topic", "echo", "/robot1/scan", "--qos-reliability", "reliable") as echo:
        echo.until("Last incompatible policy: RELIABILITY\n")
        echo.interrupt()
        outcome = echo.end()
    assert outcome.out == ""
    assert re.fullmatch(
        r"\[WARN\] \[\d+\.\d{9}\] \[\w+\]: New publisher discovered on topic '/robot1/scan', offering incompatible "
        r"QoS. No messages will be received from it. Last incompatible policy: RELIABILITY\n",
        outcome.err,
    )


def test_the_option_for_lost_messages_is_taken_and_called_old():
    outcome = ros2("topic", "echo", "/chatter", "--once", "--lost-messages")
    assert outcome.err == "WARNING: '--lost-messages' is deprecated; lost messages are reported by default\n"
    assert (outcome.out.count("---\n"), outcome.status) == (1, 0)


def test_publishers_that_differ_are_all_echoed():
    with Running("topic", "echo", "/mixed") as echo:
        echo.until("from publisher 0")
        echo.until("from publisher 1")
        echo.interrupt()
        out = echo.end().out
    assert out.startswith(
        "Some, but not all, publishers are offering QoSReliabilityPolicy.RELIABLE. Falling back to "
        "QoSReliabilityPolicy.BEST_EFFORT as it will connect to all publishers\ndata: from publisher"
    )


def test_a_topic_of_two_types_needs_a_type():
    with Running("topic", "pub", "/chatter", "std_msgs/msg/Int32") as other:
        other.until("publishing #1")
        refused = ros2("topic", "echo", "/chatter")
        echoed = ros2("topic", "echo", "/chatter", "std_msgs/msg/Int32", "--once")
    types = "std_msgs/msg/Int32, std_msgs/msg/String"
    assert refused.err == f"Cannot echo topic '/chatter', as it contains more than one type: [{types}]\n"
    assert echoed.out == "data: 0\n---\n"


def test_echo_ends_when_nobody_reads_it():
    with Running("topic", "echo", "/chatter") as echo:
        echo.until("---")
        echo.stop_reading()
        assert echo.end().status == 1
        assert "Traceback" not in echo.err


# pub -------------------------------------------------------------------------------------------------------------


def test_what_is_published_arrives():
    with Running("topic", "echo", "/robot1/cmd_vel", "--csv") as echo:
        wait_for_subscriptions("/robot1/cmd_vel", 2)
        words = ("/robot1/cmd_vel", "geometry_msgs/msg/Twist", "{linear: {x: 1.5}}")
        outcome = ros2("topic", "pub", "-t", "4", "-r", "20", "-p", "2", "-w", "2", *words)
        echo.until("1.5,0.0,0.0,0.0,0.0,0.0\n", count=4)
        echo.interrupt()
        assert echo.end().out == "1.5,0.0,0.0,0.0,0.0,0.0\n" * 4
    shown = TWIST.format("1.5", STILL)
    loop = "".join(f"publishing #{n}: {shown}\n\n" for n in (2, 4))
    assert outcome.out.replace("Waiting for at least 2 matching subscription(s)...\n", "") == (
        f"publisher: beginning loop\n{loop}"
    )
    assert (outcome.err, outcome.status) == ("", 0)


def wait_for_subscriptions(topic: str, count: int) -> None:
    what = f"Subscription count: {count}\n"
    wait_until(lambda: what in ros2("topic", "info", topic).out, what)


def test_pub_goes_on_at_its_rate_until_it_is_interrupted():
    with Running("topic", "pub", "-r", "50", "/count", "std_msgs/msg/Int32", "{data: 3}") as pub:
        pub.until("publishing #40:")
        pub.interrupt()
        outcome = pub.end()
    assert (outcome.err, outcome.status) == ("", INTERRUPTED)
    assert outcome.out.startswith(
        "publisher: beginning loop\npublishing #1: std_msgs.msg.Int32(data=3)\n\npublishing #2: "
    )


def test_a_header_gets_the_time_of_sending():
    words = ("/stamped", "geometry_msgs/msg/PointStamped", "{header: auto}")
    out = ros2("topic", "pub", "-t", "2", "-r", "10", "-w", "0", *words).out
    times = [(int(s), int(n)) for s, n in re.findall(r"Time\(sec=(\d+), nanosec=(\d+)\)", out)]
    assert len(times) == 2
    assert times[0] < times[1]


def test_values_may_come_from_the_standard_input():
    words = ("topic", "pub", "--stdin", "--once", "-w", "0", "/words", "std_msgs/msg/String")
    with Running(*words, stdin="data: |\n  two\n  lines\n") as pub:
        assert pub.end().out == (
            "publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='two\\nlines\\n')\n\n"
        )


def test_the_publishing_node_may_have_a_name():
    with Running("topic", "pub", "-n", "teacher", "/lesson", "std_msgs/msg/String") as pub:
        pub.until("publishing #1")
        assert any("/teacher\n" in ros2("node", "list").out for _ in range(20))
        pub.interrupt()
        assert pub.end().status == INTERRUPTED
    assert any("/teacher\n" not in ros2("node", "list").out for _ in range(20))


@pytest.mark.parametrize(("limit", "lines"), [("0.5", 1), ("1", 2)])  # a line each second, and at the end of one
def test_pub_waits_for_subscriptions_as_long_as_it_is_told(limit, lines):
    outcome = ros2(
        "topic", "pub", "--once", "--max-wait-time-secs", limit, "/robot1/cmd_val", "geometry_msgs/msg/Twist"
    )
    assert outcome.out == "Waiting for at least 1 matching subscription(s)...\n" * lines
    assert outcome.err == (
        "Did you mean /robot1/cmd_vel?\n"
        "Timed out waiting for subscribers: Expected 1 subcribers but only got 0 subscribers\n"
    )
    assert outcome.status == 1


def test_a_subscription_that_asks_for_more_is_warned_of():
    words = ("--qos-reliability", "best_effort", "-r", "5", "/robot1/cmd_vel", "geometry_msgs/msg/Twist")
    with Running("topic", "pub", *words) as pub:
        pub.until("New subscription discovered on topic '/robot1/cmd_vel', requesting incompatible QoS.")
        pub.until("Last incompatible policy: RELIABILITY\n")


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (("std_msgs/msg/Int32", "{data: ten}"), f"Failed to populate field: {TEN}"),
        (("std_msgs/msg/Int32", "{dat: 1}"), "Failed to populate field: 'Int32' object has no attribute 'dat'"),
        (("std_msgs/msg/Int32", "[1]"), "The passed value needs to be a dictionary in YAML format"),
        (("std_msgs/msg/Int32", "{data: 1"), "The passed value needs to be in YAML string or a dictionary"),
        (("std_srvs/srv/Trigger",), "The passed message type is invalid"),
        (("Int32",), "The passed message type is invalid"),
        (
            ("std_msgs/msg/Int32", "--max-wait-time-secs", "1"),
            "--max-wait-time-secs option is only effective with --wait-matching-subscriptions, --once or --times",
        ),
        (
            ("std_msgs/msg/Int32", "-n", "a b"),
            "Invalid node name: node name must not contain characters other than alphanumerics or '_'",
        ),
    ],
)  # fmt: skip
def test_what_pub_cannot_do_is_said_in_a_line(words, error):
    outcome = ros2("topic", "pub", "/numbers", *words)
    assert (outcome.out, outcome.err.splitlines()[0], outcome.status) == ("", error, 1)
    assert all(line.startswith("Did you mean ") for line in outcome.err.splitlines()[1:])


# In a kernel -------------------------------------------------------------------------------------------------------


def test_echo_and_pub_leave_a_process_that_goes_on_as_it_was(capfd):
    own = observer_node.node()
    before = len(list(own.publishers)), len(list(own.clients)), len(list(own.subscriptions))
    for number in range(3):
        assert run(("topic", "echo", "/chatter", "--once")) == 0
        assert run(("topic", "echo", "/chatter", "--duration", "3", "--qos-depth", "5")) == 0
        assert run(("topic", "pub", "-t", "2", "-r", "50", "-w", "0", "/n", "std_msgs/msg/Int32")) == 0
        out = capfd.readouterr().out
        assert out.count("data: 'Hello ROS2: ") > 1, number
        assert out.endswith("publishing #2: std_msgs.msg.Int32(data=0)\n\n")
    wait_until(lambda: (len(list(own.publishers)), len(list(own.clients)), len(list(own.subscriptions))) == before)
    assert rclpy.ok()


# Without ROS's graph -----------------------------------------------------------------------------------------------


def test_the_qos_that_can_be_asked_for_is_what_rclpy_knows():
    assert list(endpoints.PROFILES) == QoSPresetProfiles.short_keys()
    assert list(endpoints.HISTORIES) == HistoryPolicy.short_keys()
    assert list(endpoints.RELIABILITIES) == ReliabilityPolicy.short_keys()
    assert list(endpoints.DURABILITIES) == DurabilityPolicy.short_keys()
    assert list(endpoints.LIVELINESSES) == LivelinessPolicy.short_keys()


def test_values_that_are_no_message_are_printed_as_python_does():
    assert message_text([1, 2], None, Shown()) == "[1, 2]\n---\n"
    assert message_text(True, {"a": 1}, Shown(), csv=True) == (
        "---Got new message, message info:---\n{'a': 1}\n---Message data:---\nTrue\n---\n"
    )


def test_of_names_with_the_same_end_the_nearest_is_suggested():
    assert did_you_mean("/turtle3/pose", ["/arm/pose", "/turtle1/pose", "/turtle1/poses"]) == (
        "Did you mean /turtle1/pose?"
    )


def test_losses_are_told_of():
    assert lost_text(2, 5) == "A message was lost!!!\n\ttotal count change:2\n\ttotal count: 5---\n"


def test_a_path_names_elements_too():
    class Pose:
        points: list[dict[str, int]] = [{"x": 1}, {"x": 2}]  # noqa: RUF012

    assert selector("points[1]")(Pose()) == {"x": 2}
    assert selector(None)(5) == 5
    with pytest.raises(CommandError, match=r"Invalid field 'points\[7\]': list index out of range"):
        selector("points[7]")(Pose())


def test_a_filter_sees_the_message_and_pythons_builtins():
    assert expression("len(m) > 2")("abc")
    assert not expression("len(m) > 2")("a")
