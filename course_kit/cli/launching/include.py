"""Launch files: found, loaded, included by others."""

from __future__ import annotations

import os
import runpy
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from course_kit.cli.launching.actions import OpaqueFunction, SetLaunchConfiguration
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.describing import arguments_of
from course_kit.cli.launching.entities import Action, Entities, LaunchDescription
from course_kit.cli.launching.substitutions import SomeSubstitutions, described, normalize, perform
from course_kit.cli.launching.uncovered import NotCoveredError, not_covered

FUNCTION = "generate_launch_description"
# Packages of ROS 2's own launch system.
_OF_LAUNCH = ("launch", "launch_ros", "launch_xml", "launch_yaml", "launch_testing", "launch_pytest")
_SYNTAX = "The launch file may have a syntax error, or its format is unknown"


class InvalidLaunchFileError(RuntimeError):
    """A launch file cannot be loaded."""


class InvalidPythonLaunchFileError(RuntimeError):
    """A launch file has no generate_launch_description()."""


def load_python_launch_file(path: str) -> LaunchDescription:
    """Run a launch file and return its description; what it raises comes through."""
    try:
        names = runpy.run_path(path, run_name="python_launch_file")
    except ModuleNotFoundError as error:
        name = error.name or ""
        if name.split(".")[0] in _OF_LAUNCH:
            raise not_covered(name) from error
        raise
    if FUNCTION not in names:
        raise InvalidPythonLaunchFileError(
            f"the launch file '{path}' has no function {FUNCTION}(), which makes its LaunchDescription"
        )
    description = names[FUNCTION]()
    if not isinstance(description, LaunchDescription):
        raise InvalidPythonLaunchFileError(
            f"launch file at '{path}': {FUNCTION}() returned {type(description).__name__}, not a LaunchDescription"
        )
    return description


def load_launch_file(path: str) -> LaunchDescription:
    """The description of a launch file of any format. InvalidLaunchFileError, NotCoveredError for what is not."""
    extension = os.path.splitext(path)[1][1:]
    kind = _format(path, extension)
    try:
        return load_python_launch_file(path) if kind == "py" else _load_tags(path, kind)
    except NotCoveredError:
        raise
    except Exception as error:
        if kind != "py":
            reason = " ".join(f"{error}".split())
            message = f"Caught exception when trying to load file of format [{kind}]: '{path}': {reason}"
            raise InvalidLaunchFileError(message) from error
        if extension != "py":
            raise InvalidLaunchFileError(_SYNTAX) from error
        raise InvalidLaunchFileError(
            f"Caught multiple exceptions when trying to load file of format [py]:\n"
            f" - {type(error).__name__}: {error}\n - InvalidFrontendLaunchFileError: {_SYNTAX}"
        ) from error


def _format(path: str, extension: str) -> str:
    """The format of a launch file: by its name, or, with another name, by how it begins."""
    known = {"py": "py", "xml": "xml", "yaml": "yaml", "yml": "yaml"}.get(extension)
    if known or not os.path.isfile(path):
        return known or "py"
    with open(path, "rb") as file:
        begin = file.read(1000).lstrip(b"\xef\xbb\xbf \t\r\n")
    return "xml" if begin.startswith(b"<") else "yaml" if extension == "launch" else "py"


def _load_tags(path: str, kind: str) -> LaunchDescription:
    # Loaded here, because tags include launch files, too.
    from course_kit.cli.launching import xml_and_yaml, xml_and_yaml_actions

    read = xml_and_yaml.xml_tag if kind == "xml" else xml_and_yaml.yaml_tag
    return xml_and_yaml_actions.description_of(read(Path(path).read_bytes()))


class LaunchDescriptionSource:
    """A launch description, given or to be loaded from where it says."""

    def __init__(
        self,
        launch_description: LaunchDescription | None = None,
        location: SomeSubstitutions = "<string>",
        method: str = "a program",
    ) -> None:
        self._description = launch_description
        self._location = normalize(location)
        self._path: str | None = None
        self.method = method

    @property
    def location(self) -> str:
        """Where it comes from."""
        return self._path if self._path is not None else described(self._location)

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """The description; loaded once."""
        if self._path is None:
            self._path = perform(context, self._location)
        if self._description is None:
            self._description = self.load(self._path)
        return self._description

    def try_get_launch_description_without_context(self) -> LaunchDescription | None:
        """The description if it can be known without running the launch file."""
        try:
            return self.get_launch_description(LaunchContext())
        except Exception:
            return None

    def load(self, path: str) -> LaunchDescription:
        """Load it from a file."""
        raise RuntimeError("this LaunchDescriptionSource was made without a launch description")


class PythonLaunchDescriptionSource(LaunchDescriptionSource):
    """A Python launch file."""

    load = staticmethod(load_python_launch_file)

    def __init__(self, launch_file_path: SomeSubstitutions) -> None:
        super().__init__(None, launch_file_path, "interpreted python launch file")


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file of any format."""

    load = staticmethod(load_launch_file)

    def __init__(self, launch_file_path: SomeSubstitutions) -> None:
        super().__init__(None, launch_file_path, "any launch file")


class IncludeLaunchDescription(Action):
    """Visits what another launch file describes."""

    def __init__(
        self,
        launch_description_source: Any,
        *,
        launch_arguments: Iterable[tuple[SomeSubstitutions, SomeSubstitutions]] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        if not isinstance(launch_description_source, LaunchDescriptionSource):
            launch_description_source = AnyLaunchDescriptionSource(launch_description_source)
        self.launch_description_source: LaunchDescriptionSource = launch_description_source
        self.launch_arguments = tuple(launch_arguments or ())

    def get_sub_entities(self) -> Entities:
        """The description, if it can be known without running the launch file."""
        description = self.launch_description_source.try_get_launch_description_without_context()
        return [] if description is None else [description]

    def execute(self, context: LaunchContext) -> Entities:
        """Set the arguments, visit the description, and go back to the including file."""
        description = self.launch_description_source.get_launch_description(context)
        before = context.local_values
        location = self.launch_description_source.location
        path = os.path.abspath(location)
        folder = os.path.dirname(path) if os.path.exists(path) else location
        context.extend_locals({"current_launch_file_path": path, "current_launch_file_directory": folder})
        names = [perform(context, name) for name, _ in self.launch_arguments]
        for argument in arguments_of(description):
            is_optional = argument._conditionally_included or argument.default_value is not None
            if not is_optional and not argument._is_given_by_an_include and argument.name not in names:
                raise RuntimeError(
                    f"Included launch description missing required argument '{argument.name}' "
                    f"(description: '{argument.description}'), given: [{', '.join(names)}]"
                )

        def back(context: LaunchContext) -> None:
            context.local_values = before

        sets = [SetLaunchConfiguration(name, value) for name, value in self.launch_arguments]
        return [*sets, description, OpaqueFunction(function=back)]
