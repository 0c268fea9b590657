"""Messages as text and back, for every message type that is installed."""

from __future__ import annotations

import importlib
import math
import subprocess
import sys
import time
from array import array
from collections import OrderedDict
from typing import Any

import numpy as np
import pytest
import yaml
from ament_index_python import get_resource, get_resources
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractGenericString,
    AbstractNestedType,
    AbstractWString,
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    NamespacedType,
)

from course_kit.cli.ros2.messages.values import NotYaml, parse, populate, stamp
from course_kit.cli.ros2.messages.yaml_text import Shown, fields, to_csv, to_dict, to_yaml
from course_kit.ros.interface_types import message_class

pytestmark = pytest.mark.by_turns("hundreds of types", of="cases")

EXAMPLES = settings(
    max_examples=6,
    deadline=None,
    database=None,
    phases=(Phase.generate, Phase.shrink),
    suppress_health_check=list(HealthCheck),
)
COVARIANCE_SIZE = "The 'covariance' numpy.ndarray() must have a size of 36"
PARTS = {"srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}
FLOATS = {"float": 32, "double": 64}
TEXT = st.one_of(
    st.sampled_from(["", "yes", "1", "~", "a: b", "- a", "'", '"', "a\nb", " a", "a ", "#", "é", "\x85", "...", "now"]),
    st.text(st.characters(codec="utf-8"), max_size=12),
)


def installed_types() -> list[Any]:
    """The classes of every message, request, response, goal, result and feedback in the ament index."""
    found = []
    for package in sorted(get_resources("rosidl_interfaces")):
        listing, _ = get_resource("rosidl_interfaces", package)
        for entry in sorted({line.rsplit(".", 1)[0] for line in listing.split()}):
            kind, name = entry.split("/")
            module = importlib.import_module(f"{package}.{kind}")
            if not hasattr(module, name):
                continue  # the listing has a request, say, beside its service
            main = getattr(module, name)
            found += [main] if kind == "msg" else [getattr(main, part) for part in PARTS[kind]]
    return found


TYPES = installed_types()
BY_NAME = {f"{t.__module__.split('.')[0]}/{t.__name__}": t for t in TYPES}


def type_called(name: str) -> Any:
    return BY_NAME[name]


def values_of(slot: Any) -> st.SearchStrategy[Any]:
    """Values that a field of a rosidl type can hold."""
    if isinstance(slot, AbstractNestedType):
        return sequences_of(slot)
    if isinstance(slot, NamespacedType):
        return messages_of(message_class("/".join(slot.namespaced_name())))
    if isinstance(slot, AbstractGenericString):
        text = TEXT.map(lambda s: s.replace("\0", "")) if isinstance(slot, AbstractWString) else TEXT
        if isinstance(slot, (BoundedString, BoundedWString)):
            return text.map(lambda s: s[: slot.maximum_size])
        return text
    return numbers_of(slot.typename)


def numbers_of(typename: str) -> st.SearchStrategy[Any]:
    if typename == "boolean":
        return st.booleans()
    if typename == "octet":
        return st.binary(min_size=1, max_size=1)
    if typename in FLOATS:
        return st.floats(width=FLOATS[typename])  # type: ignore[arg-type]
    bits = int(typename.lstrip("uint"))
    low, high = (0, 2**bits - 1) if typename.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return st.integers(low, high)


def sequences_of(slot: Any) -> st.SearchStrategy[Any]:
    if isinstance(slot, Array):
        sizes = {"min_size": slot.size, "max_size": slot.size}
    else:
        most = 2 if isinstance(slot.value_type, NamespacedType) else 4
        sizes = {"max_size": min(most, slot.maximum_size) if isinstance(slot, BoundedSequence) else most}
    element = values_of(slot.value_type)
    if isinstance(slot, Array) and slot.size > 8:  # a matrix of 36 numbers need not have 36 different ones
        return st.lists(element, min_size=1, max_size=8).map(lambda v: (v * slot.size)[: slot.size])
    return st.lists(element, **sizes)


def messages_of(message_type: Any) -> st.SearchStrategy[Any]:
    def made(values: dict[str, Any]) -> Any:
        message = message_type()
        for name, value in values.items():
            default = getattr(message, name)
            if isinstance(default, array):
                value = array(default.typecode, value)
            elif isinstance(default, np.ndarray):
                value = np.array(value, dtype=default.dtype)
            message._check_fields = False  # the check of float32 refuses the largest one
            setattr(message, name, value)
        return message

    return st.fixed_dictionaries({name: values_of(slot) for name, slot in fields(message_type)}).map(made)


def reference_yaml(message: Any, shown: Shown, flow_style: bool) -> str:
    """What the real command does: PyYAML's emitter on ordered dictionaries."""

    class Dumper(yaml.Dumper):
        pass

    def represent(dumper: Any, data: Any) -> Any:
        pairs = [(dumper.represent_data(k), dumper.represent_data(v)) for k, v in data.items()]
        return yaml.nodes.MappingNode("tag:yaml.org,2002:map", pairs)

    def ordered(value: Any) -> Any:
        if isinstance(value, dict):
            return OrderedDict((k, ordered(v)) for k, v in value.items())
        return [ordered(v) for v in value] if isinstance(value, list) else value

    def represent_text(dumper: Any, data: str) -> Any:
        # Our one difference: PyYAML reads these line breaks as others than it wrote, unless they are escaped.
        style = '"' if {"\x85", "\u2028", "\u2029"} & set(data) else None
        return dumper.represent_scalar("tag:yaml.org,2002:str", data, style)

    Dumper.add_representer(OrderedDict, represent)
    Dumper.add_representer(str, represent_text)
    return str(
        yaml.dump(
            ordered(to_dict(message, shown)),
            Dumper=Dumper,
            allow_unicode=True,
            width=sys.maxsize,
            default_flow_style=flow_style,
        )
    )


def equal(one: Any, other: Any) -> bool:
    """Return True if two messages hold the same values, a NaN being equal to a NaN."""
    if hasattr(one, "get_fields_and_field_types"):
        return type(one) is type(other) and all(
            equal(getattr(one, name), getattr(other, name)) for name, _ in fields(type(one))
        )
    if isinstance(one, (list, tuple, array, np.ndarray)):
        return type(one) is type(other) and len(one) == len(other) and all(map(equal, one, other))
    if isinstance(one, (float, np.floating)):
        return bool(one == other) or (math.isnan(one) and math.isnan(other))
    return bool(one == other)


def test_all_kinds_of_types_are_installed():
    names = {f"{t.__module__.split('.')[0]}/{t.__name__}" for t in TYPES}
    assert {"sensor_msgs/LaserScan", "std_msgs/Byte", "std_srvs/SetBool_Request", "turtlesim/Pose"} <= names
    assert {"example_interfaces/Fibonacci_Goal", "example_interfaces/Fibonacci_Feedback"} <= names
    assert len(names) > 200


@pytest.mark.parametrize("message_type", TYPES, ids=lambda t: f"{t.__module__.split('.')[0]}/{t.__name__}")
def test_every_type_survives_the_way_to_text_and_back(message_type):
    @EXAMPLES
    @given(messages_of(message_type))
    def check(message: Any) -> None:
        text = to_yaml(message)
        assert text == reference_yaml(message, Shown(), flow_style=False)
        for written in (text, to_yaml(message, flow_style=True)):
            again = message_type()
            assert populate(again, parse(written)) == []
            assert equal(again, message)
            assert to_yaml(again) == text
        assert repr(again).startswith(f"{message_type.__module__.rsplit('.', 1)[0]}.{message_type.__name__}(")

    check()


@pytest.mark.parametrize(
    "message_type",
    [
        type_called(name)
        for name in (
            "sensor_msgs/LaserScan",
            "sensor_msgs/PointCloud2",
            "rcl_interfaces/ParameterValue",
            "diagnostic_msgs/DiagnosticArray",
            "geometry_msgs/PoseWithCovariance",
            "std_msgs/ByteMultiArray",
        )
    ],
    ids=lambda t: t.__name__,
)
def test_what_echo_leaves_out_and_its_flow_style_are_as_the_real_ones(message_type):
    @EXAMPLES
    @given(messages_of(message_type), st.booleans(), st.booleans(), st.integers(0, 5), st.booleans())
    def check(message: Any, no_arr: bool, no_str: bool, length: int, flow_style: bool) -> None:
        shown = Shown(length, no_arr, no_str)
        assert to_yaml(message, shown, flow_style) == reference_yaml(message, shown, flow_style)

    check()


def scan() -> Any:
    message = type_called("sensor_msgs/LaserScan")(ranges=[1.0, 2.5], range_min=0.1)
    message.header.frame_id = "laser"
    return message


def test_values_with_commas():
    assert to_csv(scan()) == "0,0,laser,0.0,0.0,0.0,0.0,0.0,0.1,0.0,1.0,2.5,"
    assert to_csv(scan(), Shown(1)) == "0,0,l...,0.0,0.0,0.0,0.0,0.0,0.1,0.0,1.0,...,"
    assert to_csv(scan(), Shown(no_arr=True, no_str=True)).endswith(
        ",0.0,<sequence type: float, length: 2>,<sequence type: float, length: 0>"
    )
    assert to_csv(type_called("std_msgs/Byte")(data=b"\5")) == r"b'\x05'"


def test_a_scan_of_360_beams_is_written_hundreds_of_times_a_second():
    message = type_called("sensor_msgs/LaserScan")(ranges=[0.01 * i for i in range(360)], intensities=[1.0] * 360)
    began = time.thread_time()
    for _ in range(100):
        to_yaml(message)
    assert time.thread_time() - began < 100 / 300


def filled(name: str, text: str) -> Any:
    message = type_called(name)()
    populate(message, parse(text))
    return message


def test_values_become_what_their_field_wants():
    assert filled("std_msgs/String", "{data: 5}").data == "5"
    assert filled("std_msgs/Int32", "{data: '7'}").data == 7
    assert filled("std_msgs/Float64", "{data: 7}").data == 7.0
    assert filled("std_msgs/Float64", "{data: 1e5}").data == 1e5  # a string in YAML 1.1
    assert filled("std_msgs/Char", "{data: 65}").data == 65
    assert [filled("std_msgs/Byte", f"{{data: {v}}}").data for v in ("5", "a", "'5'")] == [b"\5", b"a", b"5"]
    assert filled("std_msgs/ByteMultiArray", "{data: [1, a]}").data == [b"\1", b"a"]
    assert filled("geometry_msgs/Twist", "{linear: {x: 2}}").linear.x == 2.0
    assert list(filled("sensor_msgs/LaserScan", "{ranges: [1, .inf]}").ranges) == [1.0, math.inf]
    assert filled("turtlesim/SetPen_Request", "{off: 1}").off == 1  # `off` is a truth value in YAML 1.1
    rows = f"{{covariance: [{', '.join(['[0, 1, 2, 3, 4, 5]'] * 6)}]}}"
    assert filled("geometry_msgs/PoseWithCovariance", rows).covariance.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0] * 6
    points = filled("geometry_msgs/Polygon", "{points: [{x: 1}, {y: 2}]}").points
    assert [(p.x, p.y) for p in points] == [(1.0, 0.0), (0.0, 2.0)]


def test_now_and_auto_stand_for_the_time_of_sending():
    message = type_called("nav_msgs/Path")()
    times = populate(
        message, parse("{header: auto, poses: [{header: {stamp: now, frame_id: map}}, {header: auto}, {}]}")
    )
    stamp(times, 12, 34)
    stamps = [message.header.stamp, *(pose.header.stamp for pose in message.poses)]
    assert [(s.sec, s.nanosec) for s in stamps] == [(12, 34), (12, 34), (12, 34), (0, 0)]
    assert message.poses[0].header.frame_id == "map"


@pytest.mark.parametrize(
    ("name", "text", "error"),
    [
        ("example_interfaces/Fibonacci_Goal", "{ordr: 5}", "'Fibonacci_Goal' object has no attribute 'ordr'"),
        ("std_msgs/Int32", "{data: ten}", "invalid literal for int() with base 10: 'ten'"),
        ("std_msgs/Int32", "{data: [1]}", "Value '[1]' is expected to be a dictionary but is a list"),
        ("std_msgs/Int32", "{data: }", "Value 'None' is expected to be a dictionary but is a NoneType"),
        ("std_msgs/Int32", "{data: {a: 1}}", "'int' object has no attribute 'a'"),
        ("std_msgs/Int32", "5", "Value '5' is expected to be a dictionary but is a int"),
        ("std_msgs/Float64", "{data: fast}", "could not convert string to float: 'fast'"),
        ("std_msgs/UInt8", "{data: 300}", "The 'data' field must be an unsigned integer in [0, 255]"),
        ("std_msgs/Byte", "{data: 256}", "a byte is a number from 0 to 255 or one character, not 256"),
        ("geometry_msgs/Twist", "{linear: 2}", "Value '2' is expected to be a dictionary but is a int"),
        ("geometry_msgs/Twist", "{linear: [1]}", "Value '[1]' is expected to be a dictionary but is a list"),
        ("geometry_msgs/Twist", "{linear: {q: 1}}", "'Vector3' object has no attribute 'q'"),
        ("geometry_msgs/Twist", "{linear: auto}", "Value 'auto' is expected to be a dictionary but is a str"),
        ("geometry_msgs/Polygon", "{points: {x: 1}}", "Value 'x' is expected to be a dictionary but is a str"),
        ("geometry_msgs/Polygon", "{points: 1}", "Value '1' is expected to be a dictionary but is a int"),
        ("geometry_msgs/PoseWithCovariance", "{covariance: [1]}", COVARIANCE_SIZE),
        ("sensor_msgs/LaserScan", "{ranges: [a]}", "must be real number, not str"),
        ("std_msgs/String", "{1: 2}", "'String' object has no attribute '1'"),
        ("std_msgs/String", "{_check_fields: true}", "'String' object has no attribute '_check_fields'"),
    ],
)  # fmt: skip
def test_a_value_that_does_not_fit_is_refused(name, text, error):
    with pytest.raises((AttributeError, TypeError, ValueError, AssertionError)) as refused:
        filled(name, text)
    assert str(refused.value) == error


@pytest.mark.parametrize(
    "text", ["{a: 1", "a: b: c", "[1, 2", "a: 'b", "\ta: 1", "{[1]: 2", "2024-13-45", "\x00", "%x"]
)
def test_malformed_yaml_is_one_line(text):
    with pytest.raises(NotYaml) as error:
        parse(text)
    assert str(error.value)
    assert "\n" not in str(error.value)


def test_text_needs_no_ros():
    code = "import sys; from course_kit.cli.ros2.messages import values, yaml_text; print('rclpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "False\n"


def test_the_classes_of_the_slots_are_those_that_the_tests_know():
    known = {"boolean", "octet", *FLOATS, *(f"{u}int{bits}" for u in ("", "u") for bits in (8, 16, 32, 64))}
    slots = [slot for message_type in TYPES for _, slot in fields(message_type)]
    elements = [slot.value_type if isinstance(slot, AbstractNestedType) else slot for slot in slots]
    assert {slot.typename for slot in elements if isinstance(slot, BasicType)} <= known
