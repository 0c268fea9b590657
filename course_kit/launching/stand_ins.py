"""The packages `launch` and `launch_ros` that a launch file imports: their modules and the names that are covered.

Another name is refused by an error that says what it needs, and which known name may have been meant.
"""

from __future__ import annotations

import difflib
import importlib
import sys
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from course_kit.launching.uncovered import not_covered

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
    "launch.action": {"entities": "Action"},
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
    "launch.event_handler": {"handlers": "EventHandler"},
    "launch.event_handlers": {"handlers": "OnExecutionComplete OnProcessExit OnProcessIO OnProcessStart OnShutdown"},
    "launch.events": {"events": "ExecutionComplete IncludeLaunchDescription Shutdown TimerEvent matches_action"},
    "launch.events.matchers": {"events": "matches_action"},
    "launch.events.process": {
        "events": "ProcessExited ProcessIO ProcessStarted ProcessStderr ProcessStdout RunningProcessEvent "
        "ShutdownProcess SignalProcess matches_executable matches_name matches_pid"
    },
    "launch.launch_context": {"context": "LaunchContext"},
    "launch.launch_description": {"entities": "LaunchDescription"},
    "launch.launch_description_sources": {"include": "AnyLaunchDescriptionSource PythonLaunchDescriptionSource"},
    "launch.logging": {"output": "get_logger"},
    "launch.some_substitutions_type": {"substitutions": "SomeSubstitutionsType=SomeSubstitutions"},
    "launch.substitution": {"substitutions": "Substitution"},
    "launch.substitutions": {
        "comparisons": "AndSubstitution EqualsSubstitution NotEqualsSubstitution NotSubstitution OrSubstitution",
        "substitutions": "Command EnvironmentVariable FindExecutable LaunchConfiguration LocalSubstitution "
        "PathJoinSubstitution PythonExpression SubstitutionFailure TextSubstitution ThisLaunchFile ThisLaunchFileDir",
    },
    "launch.utilities": {"substitutions": "normalize_to_list_of_substitutions=normalize perform_substitutions=perform"},
    "launch_ros": {},
    "launch_ros.actions": {"node": "Node PushROSNamespace PushRosNamespace=PushROSNamespace SetParameter SetRemap"},
    "launch_ros.descriptions": {"parameters": "ParameterFile ParameterValue"},
    "launch_ros.parameter_descriptions": {"parameters": "ParameterFile ParameterValue"},
    "launch_ros.substitutions": {
        "package_substitutions": "ExecutableInPackage FindPackage FindPackagePrefix FindPackageShare"
    },
}
PACKAGES = ("launch", "launch.events", "launch_ros")


class _Finder(MetaPathFinder, Loader):
    """Makes the modules of the table when they are imported."""

    def find_spec(self, name: str, *_: object) -> ModuleSpec | None:
        """Where a module of the table comes from: from here."""
        return ModuleSpec(name, self, is_package=name in PACKAGES) if name in COVERED else None

    def exec_module(self, module: ModuleType) -> None:
        """Fill a module with its names."""
        known: dict[str, Any] = {}
        for place, names in COVERED[module.__name__].items():
            origin = importlib.import_module(f"course_kit.launching.{place}")
            pairs = (name.partition("=") for name in names.split())
            known |= {theirs: getattr(origin, ours or theirs) for theirs, _, ours in pairs}

        def other(name: str) -> Any:
            """A submodule of that name, or an error for what is not covered."""
            if name.startswith("__"):
                raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
            full_name = f"{module.__name__}.{name}"
            if full_name in COVERED:
                return importlib.import_module(full_name)
            raise not_covered(full_name, difflib.get_close_matches(name, known, n=1, cutoff=0.8))

        vars(module).update(known, __all__=list(known), __getattr__=other)


_finder = _Finder()


def install() -> None:
    """Have `import launch` and `import launch_ros` find these modules from now on, in this process."""
    if _finder not in sys.meta_path:
        sys.meta_path.insert(0, _finder)
