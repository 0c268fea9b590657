"""Command lines of `ros2` that make no sense, and what must be said of each: the table of test_ros2_bad_input.py."""

from __future__ import annotations

from tests.ros2_bad_calls.nodes import INTERFACE_AND_PKG, LIFECYCLE, NODE_AND_PARAM
from tests.ros2_bad_calls.programs import BAG, RUN_LAUNCH_DOCTOR
from tests.ros2_bad_calls.topics import ACTION, SERVICE, TOPIC

CALLS = [
    *TOPIC,
    *SERVICE,
    *ACTION,
    *NODE_AND_PARAM,
    *LIFECYCLE,
    *INTERFACE_AND_PKG,
    *RUN_LAUNCH_DOCTOR,
    *BAG,
]
