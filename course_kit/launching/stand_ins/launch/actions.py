"""Stands in for launch.actions."""

from course_kit.launching.actions import (
    AppendEnvironmentVariable,
    DeclareLaunchArgument,
    GroupAction,
    LogInfo,
    OpaqueFunction,
    SetEnvironmentVariable,
    SetLaunchConfiguration,
    UnsetEnvironmentVariable,
    UnsetLaunchConfiguration,
)
from course_kit.launching.event_actions import (
    EmitEvent,
    RegisterEventHandler,
    Shutdown,
    TimerAction,
    UnregisterEventHandler,
)
from course_kit.launching.include import IncludeLaunchDescription
from course_kit.launching.process import ExecuteProcess
from course_kit.launching.process import ExecuteProcess as ExecuteLocal
from course_kit.launching.uncovered import attributes_of

__all__ = [
    "AppendEnvironmentVariable",
    "DeclareLaunchArgument",
    "EmitEvent",
    "ExecuteLocal",
    "ExecuteProcess",
    "GroupAction",
    "IncludeLaunchDescription",
    "LogInfo",
    "OpaqueFunction",
    "RegisterEventHandler",
    "SetEnvironmentVariable",
    "SetLaunchConfiguration",
    "Shutdown",
    "TimerAction",
    "UnregisterEventHandler",
    "UnsetEnvironmentVariable",
    "UnsetLaunchConfiguration",
]
__getattr__ = attributes_of(__name__, __all__)
