"""Whatever text `ros2` is given for a name, a type, YAML, a field, a number: it is read, or refused as documented."""

from __future__ import annotations

import math
from argparse import ArgumentTypeError
from typing import Any

from geometry_msgs.msg import Twist
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Path
from rcl_interfaces.msg import ParameterValue
from rclpy.serialization import serialize_message
from sensor_msgs.msg import LaserScan
from std_msgs.msg import ByteMultiArray, String

from course_kit.cli.ros2 import command, verbs
from course_kit.cli.ros2.interface.interface import path
from course_kit.cli.ros2.launch.launch import parse_arguments
from course_kit.cli.ros2.messages.arguments import checked_name, checked_node_name, interface_class
from course_kit.cli.ros2.messages.values import NotYaml, parse, populate
from course_kit.cli.ros2.param.param import with_value
from course_kit.cli.ros2.topic import endpoints
from course_kit.cli.ros2.topic.echo_text import expression, selector
from course_kit.cli.ros2.verbs import CommandError
from course_kit.lab.bags import qos
from course_kit.ros.interface_types import steps

EXAMPLES = settings(max_examples=200, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
TEXT = st.text(max_size=30)  # no lone surrogates: a word that has one is refused before it is parsed
MESSAGES = (Twist, LaserScan, Path, String, ByteMultiArray, ParameterValue)
FIELDS = sorted({name for kind in MESSAGES for name in kind.get_fields_and_field_types()})


def made_of(*pieces: str, most: int = 8) -> st.SearchStrategy[str]:
    """Texts that are put together from pieces, and others among them."""
    return st.lists(st.sampled_from(pieces) | st.text(max_size=2), max_size=most).map("".join)


NAMES = TEXT | made_of("/", "~", "a", "_", "turtle1", "{node}", "{", "}", "//", "1", " ", "é", "x" * 300)
TYPES = TEXT | made_of(
    "std_msgs", "/", "msg", "srv", "action", "String", "__init__", "_string", "..", "turtlesim", "Spawn"
)
PATHS = TEXT | made_of(*FIELDS, ".", "[", "]", "[0]", "[-1]", "x", "poses[0]", "9" * 20, "__class__", "__dict__")
NUMBERS = (
    made_of("1", "0", ".", "e", "-", "+", "_", "nan", "inf", "9" * 30, "1e400", "٣", " ", "0x")
    | st.floats().map(repr)
    | st.integers().map(str)
)
SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | TEXT | st.dates() | st.binary(max_size=4)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(FIELDS) | TEXT, inner, max_size=4),
    max_leaves=12,
)
YAML = made_of(
    *"{}[]:,-&*!|>'\"%@#?~\n\t",
    *FIELDS,
    *(": ", "- ", "&a ", "*a", "!!int ", "!!timestamp ", "!!binary ", "<<", "\\ud800", "now", "auto", ".inf", ".nan"),
    *("0x", "0b", "1:99", "1e400", "9" * 30, "2001-13-01", "{data: x}", "[1, 2]", "true"),
    most=14,
)


@EXAMPLES
@given(NAMES)
def test_names(text: str) -> None:
    for check in (
        endpoints.full_name,
        checked_node_name,
        lambda name: checked_name(name, "service"),
        lambda name: checked_name(name, "action"),
    ):
        try:
            assert text in check(text)
        except CommandError as error:
            assert str(error)


@EXAMPLES
@given(TYPES)
def test_types(text: str) -> None:
    for kind in ("msg", "srv", "action"):
        try:
            assert isinstance(interface_class(text, kind), type)
        except CommandError as error:
            assert "type is" in str(error)
    try:
        assert path(text)
    except (LookupError, ValueError) as error:
        assert str(error)


@EXAMPLES
@given(YAML | TEXT)
def test_yaml(text: str) -> None:
    try:
        value = parse(text)
    except NotYaml as error:
        assert str(error)
        assert "\n" not in str(error)
        return
    fill(value)
    try:
        qos.overrides(value)
    except ValueError as error:
        assert str(error)


@EXAMPLES
@given(VALUES)
def test_values(value: Any) -> None:
    fill(value)


def fill(value: Any) -> None:
    """Fill messages in with a value: all can be sent, or it is refused."""
    for kind in MESSAGES:
        message = kind()
        try:
            populate(message, value)
        except (AttributeError, TypeError, ValueError, OverflowError, AssertionError) as error:
            assert str(error)
        else:
            serialize_message(message)


@EXAMPLES
@given(YAML | NUMBERS | TEXT)
def test_parameters(text: str) -> None:
    try:
        serialize_message(with_value("a", text))
    except CommandError as error:
        assert "is no value of a parameter" in str(error)


@EXAMPLES
@given(PATHS, st.sampled_from(MESSAGES))
def test_field_paths(text: str, kind: type) -> None:
    assert steps(text)
    try:
        selector(text)(kind())
    except CommandError as error:
        assert str(error).startswith("Invalid field ")


@EXAMPLES
@given(
    made_of("m", ".", "(", ")", "[", "]", " and ", "1", "'", "lambda", ":", "\\", "\n", "=", "*", "x", "\ud800") | TEXT
)
def test_filters(text: str) -> None:
    try:
        assert callable(expression(text))
    except CommandError as error:
        assert str(error).startswith("Invalid filter expression ")


@EXAMPLES
@given(NUMBERS | TEXT)
def test_times_and_counts(text: str) -> None:
    for convert, least, most in (
        (verbs.seconds, 0.0, verbs.LONGEST),
        (verbs.positive_float, 0.0, verbs.LONGEST),
        (verbs.whole, 0, verbs.LARGEST),
    ):
        try:
            number = convert(text)
        except ArgumentTypeError as error:
            assert str(error).startswith("invalid ")
        else:
            assert math.isfinite(number)
            assert least <= number <= most


@EXAMPLES
@given(st.lists(made_of("a", ":=", "=", ":", " ") | TEXT, max_size=3))
def test_launch_arguments(words: list[str]) -> None:
    try:
        assert all(f"{name}:={value}" in words for name, value in parse_arguments(words).items())
    except CommandError as error:
        assert str(error).startswith("malformed launch argument ")


@EXAMPLES
@given(
    st.lists(
        st.sampled_from([*command.COMMANDS, "list", "echo", "pub", "-r", "--once", "-t", "--", "-1"]) | TEXT, max_size=6
    )
)
def test_command_lines(words: list[str]) -> None:
    """They are parsed, or refused with the usage (SystemExit); nothing is run."""
    try:
        assert command.parser_for(words).parse_args(words).named
    except SystemExit as ending:
        assert ending.code in (0, 2)
