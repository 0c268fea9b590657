"""The packages `launch` and `launch_ros` that a launch file imports: their modules and the names that are covered.

Another name is refused by an error that says what it needs, and which known name may have been meant.
"""

from __future__ import annotations

import difflib
import importlib
import re
import sys
from collections.abc import Iterable
from functools import partial
from types import ModuleType
from typing import Any, NoReturn

from course_kit.cli.launching.uncovered import not_covered

# Module -> {module of this package: names from there}; theirs=ours where ours has another name.
COVERED: dict[str, dict[str, str]] = {
    "launch": {
        "conditions": "Condition",
        "context": "LaunchContext",
        "entities": "Action LaunchDescription LaunchDescriptionEntity",
        "events": "Event",
        "handlers": "EventHandler SomeEntitiesType=SomeEntities",
        "include": "LaunchDescriptionSource",
        "service": "LaunchService",
        "substitutions": "SomeSubstitutionsType=SomeSubstitutions Substitution",
    },
    "launch.actions": {
        "actions": "AppendEnvironmentVariable DeclareLaunchArgument GroupAction LogInfo OpaqueFunction "
        "SetEnvironmentVariable SetLaunchConfiguration UnsetEnvironmentVariable UnsetLaunchConfiguration",
        "event_actions": "EmitEvent RegisterEventHandler Shutdown TimerAction UnregisterEventHandler",
        "include": "IncludeLaunchDescription",
        "process": "ExecuteLocal=ExecuteProcess ExecuteProcess",
    },
    "launch.conditions": {
        "conditions": "IfCondition InvalidConditionExpressionError LaunchConfigurationEquals "
        "LaunchConfigurationNotEquals UnlessCondition"
    },
    "launch.event_handlers": {"handlers": "OnExecutionComplete OnProcessExit OnProcessIO OnProcessStart OnShutdown"},
    "launch.events": {"events": "ExecutionComplete IncludeLaunchDescription Shutdown TimerEvent matches_action"},
    "launch.events.matchers": {"events": "matches_action"},
    "launch.events.process": {
        "events": "ProcessExited ProcessIO ProcessStarted ProcessStderr ProcessStdout RunningProcessEvent "
        "ShutdownProcess SignalProcess matches_executable matches_name matches_pid"
    },
    "launch.launch_description_sources": {
        "include": "AnyLaunchDescriptionSource FrontendLaunchDescriptionSource=AnyLaunchDescriptionSource "
        "PythonLaunchDescriptionSource"
    },
    "launch.logging": {"output": "get_logger"},
    "launch.some_substitutions_type": {"substitutions": "SomeSubstitutionsType=SomeSubstitutions"},
    "launch.substitutions": {
        "conditions": "AllSubstitution AndSubstitution AnySubstitution EqualsSubstitution IfElseSubstitution "
        "NotEqualsSubstitution NotSubstitution OrSubstitution",
        "machine_substitutions": "AnonName Command FileContent FindExecutable LaunchLogDir",
        "substitutions": "EnvironmentVariable LaunchConfiguration LocalSubstitution PathJoinSubstitution "
        "PythonExpression SubstitutionFailure TextSubstitution ThisLaunchFile ThisLaunchFileDir",
    },
    "launch.utilities": {"substitutions": "normalize_to_list_of_substitutions=normalize perform_substitutions=perform"},
    "launch_ros": {},
    "launch_ros.actions": {
        "lifecycle": "LifecycleNode",
        "node": "Node PushROSNamespace PushRosNamespace=PushROSNamespace SetParameter SetParametersFromFile SetRemap",
    },
    "launch_ros.descriptions": {"parameters": "ParameterFile ParameterValue"},
    "launch_ros.event_handlers": {"lifecycle": "OnStateTransition"},
    "launch_ros.events": {},
    "launch_ros.events.lifecycle": {"lifecycle": "ChangeState StateTransition"},
    "launch_ros.parameter_descriptions": {"parameters": "ParameterFile ParameterValue"},
    "launch_ros.substitutions": {
        "package_substitutions": "ExecutableInPackage FindPackage FindPackagePrefix FindPackageShare"
    },
    "launch_xml": {},
    "launch_xml.launch_description_sources": {"include": "XMLLaunchDescriptionSource=AnyLaunchDescriptionSource"},
    "launch_yaml": {},
    "launch_yaml.launch_description_sources": {"include": "YAMLLaunchDescriptionSource=AnyLaunchDescriptionSource"},
}


# The module of its own that a class has in the package, where that is not called after the class.
OWN_MODULES = {
    **dict.fromkeys(("All", "And", "Any", "Not", "Or"), "boolean_substitution"),
    "FindPackagePrefix": "find_package",
    "FindPackageShare": "find_package",
    "launch.actions.Shutdown": "shutdown_action",
}


def install() -> None:
    """Have `import launch` and `import launch_ros` find these modules from now on, in this process."""
    modules: dict[str, dict[str, Any]] = {name: {} for name in COVERED}
    for module_name, places in COVERED.items():
        for place, names in places.items():
            origin = importlib.import_module(f"course_kit.cli.launching.{place}")
            for theirs, _, ours in (name.partition("=") for name in names.split()):
                thing = modules[module_name][theirs] = getattr(origin, ours or theirs)
                if isinstance(thing, type):
                    own_name = _own_module(module_name, theirs)
                    modules.setdefault(own_name, {})[theirs] = thing
                    if thing.__module__.startswith("course_kit") and thing.__name__ == theirs:
                        thing.__module__ = own_name  # for --print and messages
    for name, known in modules.items():
        module = sys.modules[name] = ModuleType(name)
        vars(module).update(known, __all__=list(known), __path__=[], __getattr__=partial(_refuse, name, list(known)))
        package, _, last_name = name.rpartition(".")
        if package:
            setattr(sys.modules[package], last_name, module)


def _own_module(module_name: str, class_name: str) -> str:
    words = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", class_name).lower()
    special = OWN_MODULES.get(class_name.removesuffix("Substitution")) or OWN_MODULES.get(f"{module_name}.{class_name}")
    return f"{module_name}.{special or words}"


def _refuse(module_name: str, known: Iterable[str], name: str) -> NoReturn:
    if name.startswith("__"):
        raise AttributeError(f"module {module_name!r} has no attribute {name!r}")
    raise not_covered(f"{module_name}.{name}", difflib.get_close_matches(name, known, n=1, cutoff=0.8))
