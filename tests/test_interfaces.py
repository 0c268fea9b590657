"""The compiled interface packages: complete, and the same on the wire as the originals."""

from __future__ import annotations

import importlib
import json
from pathlib import Path

import pytest
import rclpy
from ament_index_python.packages import get_package_share_directory
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from turtlesim.msg import Pose

DEFINITIONS = Path(__file__).parents[1] / "course_kit/setup/interfaces"
# RIHS01 hashes of the original packages, as ROS 2 Jazzy announces them.
HASHES = {
    "turtlesim/msg/Pose": "739beba26bcba6920404ba722b7b8321348512f92ea5be235c47251940dd8aa9",
    "example_interfaces/srv/AddTwoInts": "e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a",
    "example_interfaces/action/Fibonacci": "9508051da1ea4658de144b09bd0690ff3de52104683d847aed764d2915906f51",
    "tf2_msgs/msg/TFMessage": "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "tf2_msgs/srv/FrameGraph": "0d1fbc6222c018ba5f33822904a2fdd4063705289956d3fdde07cd8c50fe8067",
    "nav2_msgs/action/NavigateToPose": "a56dba8a3234a1215e610180dc703ae25bbf406dded8b54887891c9732857eab",
}
NUMBERS = ["Float32", "Float64", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32", "UInt64"]
NAMES = {
    "example_interfaces": {
        "msg": ["Bool", "Byte", "Char", "Empty", "MultiArrayDimension", "MultiArrayLayout", "String", "WString"]
        + ["ByteMultiArray"]
        + NUMBERS
        + [f"{number}MultiArray" for number in NUMBERS],
        "srv": ["AddTwoInts", "SetBool", "Trigger"],
        "action": ["Fibonacci"],
    },
    "turtlesim": {
        "msg": ["Color", "Pose"],
        "srv": ["Kill", "SetPen", "Spawn", "TeleportAbsolute", "TeleportRelative"],
        "action": ["RotateAbsolute"],
    },
    "tf2_msgs": {"msg": ["TF2Error", "TFMessage"], "srv": ["FrameGraph"], "action": ["LookupTransform"]},
    "nav2_msgs": {"action": ["NavigateToPose"]},  # the one that the course uses
}


@pytest.mark.parametrize("interface", HASHES)
def test_type_hashes_equal_the_originals(interface):
    package, kind, name = interface.split("/")
    description = json.loads(Path(get_package_share_directory(package), kind, f"{name}.json").read_text())
    hashes = {entry["type_name"]: entry["hash_string"] for entry in description["type_hashes"]}
    assert hashes[interface] == f"RIHS01_{HASHES[interface]}"


@pytest.fixture
def node():
    context = rclpy.context.Context()
    rclpy.init(context=context)
    node = Node("interfaces", context=context)
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)


def test_the_hash_of_a_pose_is_announced_on_the_wire(node):
    node.create_publisher(Pose, "pose", 10)
    (endpoint,) = node.get_publishers_info_by_topic("pose")
    assert str(endpoint.topic_type_hash) == f"RIHS01_{HASHES['turtlesim/msg/Pose']}"


@pytest.mark.parametrize("package", NAMES)
def test_every_message_service_and_action_of_the_originals_is_there(package):
    for kind, names in NAMES[package].items():
        module = importlib.import_module(f"{package}.{kind}")
        share = Path(get_package_share_directory(package), kind)
        assert sorted(names) == sorted(path.stem for path in share.glob(f"*.{kind}"))
        for name in names:
            assert hasattr(module, name), f"{package}/{kind}/{name}"


@pytest.mark.parametrize("name", [n for n in NAMES["example_interfaces"]["msg"] if n not in ("WString",)])
def test_example_messages_have_the_fields_of_std_msgs(name):
    ours = getattr(importlib.import_module("example_interfaces.msg"), name).get_fields_and_field_types()
    theirs = getattr(importlib.import_module("std_msgs.msg"), name).get_fields_and_field_types()
    assert ours == {field: kind.replace("std_msgs/", "example_interfaces/") for field, kind in theirs.items()}


def test_a_service_and_an_action_of_the_compiled_types_run(node):
    def add(request, response):
        response.sum = request.a + request.b
        return response

    def count(goal):
        goal.succeed()
        return Fibonacci.Result(sequence=[0, 1, 1, 2][: goal.request.order])

    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    node.create_service(AddTwoInts, "add", add)
    answer = node.create_client(AddTwoInts, "add").call_async(AddTwoInts.Request(a=2**62, b=-1))
    executor.spin_until_future_complete(answer, timeout_sec=10)
    assert answer.result().sum == 2**62 - 1

    server = ActionServer(node, Fibonacci, "count", count)
    client = ActionClient(node, Fibonacci, "count")
    sent = client.send_goal_async(Fibonacci.Goal(order=3))
    executor.spin_until_future_complete(sent, timeout_sec=10)
    result = sent.result().get_result_async()
    executor.spin_until_future_complete(result, timeout_sec=10)
    assert list(result.result().result.sequence) == [0, 1, 1]
    client.destroy()
    server.destroy()
    executor.shutdown()
