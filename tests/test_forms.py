"""What is typed into a form: read or refused in a sentence, and the same as a message, a command and a program."""

from __future__ import annotations

import copy
import math
import shlex
from typing import Any

import pytest
from example_interfaces.action import Fibonacci
from example_interfaces.msg import Byte, Int8
from geometry_msgs.msg import PoseWithCovariance, Twist
from hypothesis import given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Path
from rcl_interfaces.msg import ParameterDescriptor
from sensor_msgs.msg import BatteryState, RegionOfInterest
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import ColorRGBA, Header, String
from turtlesim.srv import Spawn

from course_kit.cli.ros2.command import parser_for
from course_kit.cli.ros2.messages.values import parse, populate
from course_kit.cli.ros2.messages.yaml_text import to_dict
from course_kit.ros.interface_types import type_name
from course_kit.views.forms.command_line import command_line
from course_kit.views.forms.fields import message_field, read
from course_kit.views.forms.interface import ACTION, SERVICE, TOPIC, Interface
from course_kit.views.forms.program import WIDTH, program
from tests.test_ros2_message_yaml import EXAMPLES, TYPES, messages_of


def filled(message_type: Any, entries: dict[str, Any]) -> dict[str, Any]:
    """The entries of a form in which some have been changed, by path."""
    root: Any = copy.deepcopy(message_field(message_type()).default)
    for path, entry in entries.items():
        *way, last = path.split(".")
        place = root
        for step in way:
            place = place[step]
        place[last] = entry
    return root


def problem(message_type: Any, entries: dict[str, Any]) -> str:
    """The one sentence that a form says of its entries."""
    _, problems = read(message_field(message_type()), filled(message_type, entries))
    (said,) = problems.values()
    return said


@pytest.mark.parametrize(
    ("message_type", "entries", "said"),
    [
        (Twist, {"linear.x": "fast"}, "linear.x takes a float64, a number such as 0.5, not 'fast'."),
        (Twist, {"linear.x": ""}, "linear.x takes a float64, a number such as 0.5, not ''."),
        (
            Twist,
            {"angular.z": "1,5"},
            "angular.z takes a float64, a number such as 0.5, with a point and no comma, not '1,5'.",
        ),
        (Int8, {"data": "300"}, "data takes an int8, a whole number from -128 to 127, not '300'."),
        (Int8, {"data": "2.0"}, "data takes an int8, a whole number from -128 to 127, not '2.0'."),
        (Byte, {"data": "-1"}, "data takes a byte, a whole number from 0 to 255, not '-1'."),
        (
            ColorRGBA,
            {"r": "1e39"},
            "r takes a float32, a number from -3.402823466e+38 to 3.402823466e+38, not '1e39'.",
        ),
        (RegionOfInterest, {"do_rectify": "yes"}, "do_rectify takes true or false, not 'yes'."),
        (
            String,
            {"data": "\ud800"},
            "data takes a string that can be sent: this one has half a character, or a NUL, in it.",
        ),
        (String, {"data": None}, "data takes a text, not None."),
        (
            Header,
            {"stamp": "later"},
            "stamp takes seconds such as 1.5, from -2147483648 to below 2147483648, or now, not 'later'.",
        ),
        (PoseWithCovariance, {"covariance": ["0"]}, "covariance is float64[36]: it takes 36 elements here, and has 1."),
        (
            SolidPrimitive,
            {"dimensions": ["1"] * 4},
            "dimensions is float64[<=3]: it takes at most 3 elements here, and has 4.",
        ),
        (SolidPrimitive, {"dimensions": ["1", "x"]}, "dimensions[1] takes a float64, a number such as 0.5, not 'x'."),
        (
            Path,
            {"poses": "none"},
            "poses is geometry_msgs/PoseStamped[]: it takes at most 100 elements here, and has none.",
        ),
    ],
)
def test_what_does_not_fit_is_refused_in_a_sentence_that_names_field_type_and_range(message_type, entries, said):
    assert problem(message_type, entries) == said


@pytest.mark.parametrize(
    ("message_type", "entries", "path", "value"),
    [
        (Int8, {"data": " 0x7f "}, "data", 127),
        (Twist, {"linear.x": "-inf"}, "linear.x", -math.inf),
        (Header, {"stamp": "now"}, "stamp", "now"),
        (Header, {"stamp": "-1.25"}, "stamp", {"sec": -2, "nanosec": 750_000_000}),
        (Header, {"stamp": "2147483647.999999999"}, "stamp", {"sec": 2147483647, "nanosec": 999_999_999}),
        (BatteryState, {"power_supply_status": "POWER_SUPPLY_STATUS_FULL"}, "power_supply_status", 4),
    ],
)
def test_what_fits_is_read(message_type, entries, path, value):
    found, problems = read(message_field(message_type()), filled(message_type, entries))
    for step in path.split("."):
        found = found[step]
    assert (found, problems) == (value, {})


def test_a_tree_has_types_defaults_bounds_and_constants():
    fields = {one.name: one for one in message_field(BatteryState()).fields}
    assert (fields["voltage"].type, fields["voltage"].default) == ("float32", "0.0")
    assert (fields["cell_voltage"].type, fields["cell_voltage"].most) == ("float32[]", 100)
    status = fields["power_supply_status"]
    assert status.type == "uint8" and status.choices[-1] == "POWER_SUPPLY_STATUS_FULL"
    assert fields["power_supply_health"].choices[0] == "POWER_SUPPLY_HEALTH_UNKNOWN"
    assert not fields["percentage"].choices
    ranges = {one.name: one for one in message_field(ParameterDescriptor()).fields}["integer_range"]
    assert (ranges.type, ranges.least, ranges.most) == ("rcl_interfaces/IntegerRange[<=1]", 0, 1)
    pose = message_field(PoseWithCovariance()).fields[0]
    assert pose.default["orientation"] == {"x": "0.0", "y": "0.0", "z": "0.0", "w": "1.0"}
    covariance = message_field(PoseWithCovariance()).fields[1]
    assert (covariance.type, covariance.least, covariance.most) == ("float64[36]", 36, 36)


def values(interface: Interface, entries: dict[str, Any]) -> Any:
    value, problems = read(interface.root, filled(interface.message_type, entries))
    assert not problems
    return value


def test_the_command_has_what_differs_from_the_defaults():
    velocity = Interface(TOPIC, "/turtle1/cmd_vel", Twist)
    value = values(velocity, {"linear.x": "2", "angular.z": "0"})
    assert command_line(velocity, value) == (
        "ros2 topic pub --once /turtle1/cmd_vel geometry_msgs/msg/Twist '{linear: {x: 2.0}}'"
    )
    assert command_line(velocity, value, 0.5).startswith("ros2 topic pub --rate 0.5 /turtle1/cmd_vel ")
    spawn = Interface(SERVICE, "/spawn", Spawn)
    assert command_line(spawn, values(spawn, {})) == "ros2 service call /spawn turtlesim/srv/Spawn"
    count = Interface(ACTION, "/fibonacci", Fibonacci)
    assert command_line(count, values(count, {"order": "5"})) == (
        "ros2 action send_goal --feedback /fibonacci example_interfaces/action/Fibonacci '{order: 5}'"
    )


def sent_by_program(interface: Interface, value: Any) -> Any:
    """The message that the program makes: its imports, and the expression behind `message =`."""
    lines = program(interface, value).splitlines()
    start = next(number for number, line in enumerate(lines) if line.startswith("message = "))
    end = next(number for number, line in enumerate(lines) if line.startswith("for _ in "))
    names: dict[str, Any] = {}
    exec("\n".join([line for line in lines if line.startswith(("from ", "import "))] + lines[start:end]), names)
    return names["message"]


def with_times_that_are_times(message: Any) -> Any:
    """A message without nanoseconds that make a second and more, and without what no text may have."""
    for name in message.get_fields_and_field_types():
        inner = getattr(message, name)
        if isinstance(inner, str):
            setattr(message, name, inner.replace("\0", ""))
        elif isinstance(inner, list) and inner and isinstance(inner[0], str):
            setattr(message, name, [text.replace("\0", "") for text in inner])
        for one in inner if isinstance(inner, list) else [inner]:
            if hasattr(one, "get_fields_and_field_types"):
                with_times_that_are_times(one)
    if type(message).__name__ in ("Time", "Duration") and hasattr(message, "nanosec"):
        message.nanosec %= 10**9
    return message


@settings(EXAMPLES, max_examples=150)
@given(st.sampled_from([t for t in TYPES if "/msg/" in type_name(t)]), st.data())
def test_what_a_form_holds_is_the_same_as_message_command_and_program(message_type: Any, data: st.DataObject) -> None:
    message = with_times_that_are_times(data.draw(messages_of(message_type)))
    interface = Interface(TOPIC, "/x", message_type)
    value, problems = read(interface.root, message_field(message).default)
    if problems:  # rosidl's own constructors refuse the largest number, by their rounding
        assert all("3.4028234663852886e+38" in said for said in problems.values())
        return
    wanted = repr(to_dict(message))  # where nan is nan, and -0.0 is not 0.0

    filled_in = message_type()
    populate(filled_in, value)
    assert repr(to_dict(filled_in)) == wanted

    words = shlex.split(command_line(interface, value))[1:]
    args = parser_for(words).parse_args(words)
    commanded = message_type()
    populate(commanded, parse(args.values))
    assert repr(to_dict(commanded)) == wanted

    assert repr(to_dict(sent_by_program(interface, value))) == wanted


def test_a_program_has_no_long_lines_where_it_can_break_them():
    path = Interface(TOPIC, "/path", Path)
    pose = filled(type(Path().header), {})  # a header, to begin with
    assert pose["frame_id"] == ""
    element = copy.deepcopy(path.root.fields[1].element.default)  # type: ignore[union-attr]
    element["pose"]["position"] = {"x": "1.5", "y": "2.5", "z": "3.5"}
    element["header"]["stamp"] = "now"
    text = program(path, values(path, {"poses": [element] * 3}))
    assert max(map(len, text.splitlines())) <= WIDTH
    assert "stamp=node.get_clock().now().to_msg()" in text
