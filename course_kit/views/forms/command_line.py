"""The values of a form as a `ros2` command. Imports no ROS itself."""

from __future__ import annotations

import shlex
from typing import Any

from course_kit.cli.ros2.messages.yaml_text import to_flow_yaml
from course_kit.views.forms.fields import changed
from course_kit.views.forms.interface import ACTION, SERVICE, Interface


def command_line(interface: Interface, value: Any, rate: float | None = None) -> str:
    """The command that sends a value, as `read()` gives it; a topic's once, or at a rate in Hz."""
    words = ["ros2", *_verb(interface, rate), interface.name, interface.type_name]
    if differing := changed(interface.root, value):
        words.append(to_flow_yaml(differing))
    return shlex.join(words)


def _verb(interface: Interface, rate: float | None) -> list[str]:
    if interface.noun == SERVICE:
        return ["service", "call"]
    if interface.noun == ACTION:
        return ["action", "send_goal", "--feedback"]
    return ["topic", "pub", *(["--once"] if rate is None else ["--rate", f"{rate:g}"])]
